// The harness's own check of statistics: right answers hold, and wrong ones are found.
#include "harness/check/verify_statistics.h"

#include "algorithms/kernel/rounding.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/scenes.h"

#include <cmath>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using Kind = Statistic::Kind;
using Over = Statistic::Over;

// A tilted unit square over a plane: the distance grows evenly from 0 to 1 over A.
const Shape tilted = [] {
    TriangleMesh mesh = sheet(2, 0);
    mesh.vertices.col(2) = mesh.vertices.col(0);
    return mesh;
}();
const Shape plane = [] {
    TriangleMesh mesh = sheet(2, 0);
    mesh.vertices.array() = mesh.vertices.array() * 4 - 1.5;
    mesh.vertices.col(2).setZero();
    return mesh;
}();

struct Value {
    Statistic statistic;
    double value;
};
const std::vector<Value> of_tilted = {{{Kind::mean}, 0.5},
                                      {{Kind::rms}, std::sqrt(1.0 / 3)},
                                      {{Kind::deviation}, std::sqrt(1.0 / 12)},
                                      {{Kind::maximum}, 1},
                                      {{Kind::quantile, 0.5}, 0.5},
                                      {{Kind::quantile, 0.95}, 0.95},
                                      {{Kind::share_within, 0.25}, 0.25}};

TEST(VerifyStatistics, RightAnswersHold) {
    StatisticsChecker checker(tilted, {}, plane, {});
    for (const auto& [statistic, value] : of_tilted) {
        const Check check = checker.check({value, value}, statistic, WeighBy::area);
        EXPECT_EQ(check.lower, Verdict::holds) << to_string(statistic) << check.reason;
        EXPECT_EQ(check.upper, Verdict::holds) << to_string(statistic) << check.reason;
        EXPECT_EQ(check.reason, "");
    }
}

TEST(VerifyStatistics, AnswersWrongByTwoPercentOfTheRangeAreRefuted) {
    StatisticsChecker checker(tilted, {}, plane, {});
    for (const auto& [statistic, value] : of_tilted) {
        const Check high = checker.check({value + 0.02, value + 0.03}, statistic, WeighBy::area);
        EXPECT_EQ(high.lower, Verdict::unsound) << to_string(statistic);
        EXPECT_EQ(high.upper, Verdict::holds) << to_string(statistic);
        EXPECT_NE(high.reason, "");
        const Check low = checker.check({value - 0.03, value - 0.02}, statistic, WeighBy::area);
        EXPECT_EQ(low.lower, Verdict::holds) << to_string(statistic);
        EXPECT_EQ(low.upper, Verdict::unsound) << to_string(statistic);
    }
    EXPECT_EQ(checker.check({0.6, 0.4}, {Kind::mean}, WeighBy::area).upper, Verdict::unsound);
    EXPECT_EQ(checker.check({NAN, 1}, {Kind::mean}, WeighBy::area).lower, Verdict::unsound);
}

TEST(VerifyStatistics, LengthsWhosePowersOverflowOrUnderflowAreNotRefuted) {
    for (const int exponent : {-400, -266, -200, 200, 260, 400}) {
        const double unit = std::ldexp(1.0, exponent);
        Shape a = tilted, b = plane;
        points_of(a) *= unit;
        points_of(b) *= unit;
        StatisticsChecker checker(a, {}, b, {});
        for (const auto& [statistic, value] : of_tilted) {
            Statistic scaled = statistic;
            if (is_share(statistic)) scaled.argument *= unit;
            const double here = is_share(statistic) ? value : value * unit;
            const Check check = checker.check({here, here}, scaled, WeighBy::area);
            const Verdict expected = std::abs(exponent) == 200 ? Verdict::holds : Verdict::not_checked;
            EXPECT_EQ(check.lower, expected) << to_string(scaled) << check.reason;
            EXPECT_EQ(check.upper, expected) << to_string(scaled) << check.reason;
        }
    }
}

TEST(VerifyStatistics, ATinyTriangleIsNotRefuted) {
    const auto triangle = [](double size) -> Points { return rows({{0, 0, 0}, {size, 0, 0}, {0, size, 0}}); };
    Points both(6, 3);
    both << triangle(1e-81), triangle(1e-69);
    both.bottomRows(3).col(2).setConstant(1e-69);
    const Shape a = soup(triangle(1e-82)), b = soup(both);  // a lies on b
    StatisticsChecker checker(a, {}, b, {});
    for (const Kind kind : {Kind::mean, Kind::rms, Kind::maximum})
        EXPECT_NE(checker.check({0, 1e-84}, {kind}, WeighBy::number).upper, Verdict::unsound);
}

TEST(VerifyStatistics, PointsAreMeasuredExactly) {
    const Shape points = PointSet{rows({{0, 0, 1}, {0, 0, 2}, {0, 0, 6}})};
    StatisticsChecker checker(points, {}, plane, {});
    const auto verdicts = [&](const Statistic& statistic, double value) {
        const Check check = checker.check({value, value}, statistic, WeighBy::number);
        return std::pair(check.lower, check.upper);
    };
    const auto hold = std::pair(Verdict::holds, Verdict::holds);
    EXPECT_EQ(verdicts({Kind::mean}, 3), hold);
    EXPECT_EQ(verdicts({Kind::mean}, 3 + 1e-9).first, Verdict::unsound);
    EXPECT_EQ(verdicts({Kind::mean}, 3 - 1e-9).second, Verdict::unsound);
    EXPECT_EQ(verdicts({Kind::quantile, 0.5}, 2), hold);
    EXPECT_EQ(verdicts({Kind::quantile, 0.5}, 2.001).first, Verdict::unsound);
    EXPECT_EQ(verdicts({Kind::share_within, 2}, 2.0 / 3), hold);
    EXPECT_EQ(verdicts({Kind::share_within, 2}, 0.7).first, Verdict::unsound);
    EXPECT_EQ(verdicts({Kind::maximum}, 6), hold);
    EXPECT_EQ(verdicts({Kind::maximum}, 5.99).second, Verdict::unsound);
}

TEST(VerifyStatistics, BothDirections) {
    const Shape far = PointSet{rows({{0, 0, 1}, {0, 0, 1}})}, near = PointSet{rows({{0, 0, 0}})};
    StatisticsChecker checker(far, {}, near, {});
    const auto holds = [&](Over over, double value) {
        const Check check = checker.check({value, value}, {Kind::share_within, 0.5, over}, WeighBy::number);
        return check.lower == Verdict::holds && check.upper == Verdict::holds;
    };
    for (const Over over :
         {Over::source, Over::target, Over::larger, Over::mean_of_both, Over::harmonic_mean, Over::pooled}) {
        EXPECT_TRUE(holds(over, 0)) << to_string(over);
        EXPECT_FALSE(holds(over, 0.3)) << to_string(over);
    }
    const auto mean = [&](Over over, double value) {
        const Check check = checker.check({value, value}, {Kind::mean, 0, over}, WeighBy::number);
        return check.lower == Verdict::holds && check.upper == Verdict::holds;
    };
    const Shape middle = PointSet{rows({{0, 0, 0}, {0, 0, 3}})};
    StatisticsChecker other(near, {}, middle, {});  // source: 0; target: 0 and 3
    const auto other_mean = [&](Over over, double value) {
        const Check check = other.check({value, value}, {Kind::mean, 0, over}, WeighBy::number);
        return check.lower == Verdict::holds && check.upper == Verdict::holds;
    };
    EXPECT_TRUE(mean(Over::pooled, 1));
    EXPECT_TRUE(other_mean(Over::source, 0));
    EXPECT_TRUE(other_mean(Over::target, 1.5));
    EXPECT_TRUE(other_mean(Over::larger, 1.5));
    EXPECT_TRUE(other_mean(Over::mean_of_both, 0.75));
    EXPECT_TRUE(other_mean(Over::harmonic_mean, 0));
    EXPECT_TRUE(other_mean(Over::pooled, 1));
    EXPECT_FALSE(other_mean(Over::pooled, 0.75));
}

// The witness of the solver proves its lower bound on the largest distance, and refutes a larger one. Some shapes are so
// small that the witness is rounded.
TEST(VerifyStatistics, TheLargestDistanceIsCheckedByItsWitness) {
    Random random(5);
    const SolverEntry& entry = find_solver("distribution");
    int of_target = 0;
    for (int i = 0; i < 60; ++i) {
        const double unit = std::ldexp(1.0, i % 3 == 0 ? -1060 : i % 3 == 1 ? 500 : 0);
        Shape a = soup(cloud(random, 12)), b = soup(cloud(random, 15));
        for (Shape* shape : {&a, &b})
            points_of(*shape) = points_of(*shape).unaryExpr([&](double x) { return std::round(256 * x) / 256 * unit; });
        QuerySet both;
        both.both_ways = true;
        const Session session(entry, Options("distribution", entry.info.parameters, {}), {a, b}, both);
        for (const Over over : {Over::source, Over::larger}) {
            Query query;
            query.quantity = Quantity::distribution;
            query.statistics = {{Kind::maximum, 0, over}};
            query.tolerance = {Tolerance::Of::absolute, std::max(1e-9 * unit, 0x1p-1074)};
            Trace untraced;
            const Result result = session.solve(query, untraced);
            Row row;
            row.spec.source = "a";
            row.spec.target = "b";
            row.spec.quantity = query.quantity;
            row.spec.statistic = to_string(query.statistics[0]);
            row.spec.certified = 1;
            row.outcome.bounds = result.statistics[0];
            row.outcome.witness = result.witness;
            of_target += result.witness.direction == Witness::Direction::target_to_source;
            std::vector<Row> rows(2, row);
            Bounds& larger = rows[1].outcome.bounds;
            larger.lower = larger.upper = std::max(larger.upper * (1 + 1e-12), next_up(larger.upper));
            verify_rows(rows, [&](const std::string& name) { return name == "a" ? &a : &b; });
            EXPECT_EQ(rows[0].check.lower, Verdict::holds) << row.spec.statistic << ": " << rows[0].check.reason;
            EXPECT_EQ(rows[0].check.upper, Verdict::holds) << row.spec.statistic << ": " << rows[0].check.reason;
            EXPECT_EQ(rows[1].check.lower, Verdict::unsound) << row.spec.statistic;
        }
    }
    EXPECT_GT(of_target, 5);
}

TEST(VerifyStatistics, PosesMoveBothShapes) {
    Pose up;
    up.translation = Vec3(0, 0, 2);
    StatisticsChecker moved(tilted, up, plane, {});
    EXPECT_EQ(moved.check({2.5, 2.5}, {Kind::mean}, WeighBy::area).reason, "");
    EXPECT_NE(moved.check({0.5, 0.5}, {Kind::mean}, WeighBy::area).reason, "");
    Pose down;
    down.translation = Vec3(0, 0, -1);
    StatisticsChecker both(tilted, up, plane, down);
    EXPECT_EQ(both.check({3.5, 3.5}, {Kind::mean}, WeighBy::area).reason, "");
}

TEST(VerifyStatistics, SegmentsAreCheckedByLength) {
    const Shape line = soup(rows({{0, 0, 1}, {0, 0, 2}, {0, 0, 2}}));
    StatisticsChecker checker(line, {}, plane, {});
    EXPECT_EQ(checker.check({1.5, 1.5}, {Kind::mean}, WeighBy::area).reason, "");
    EXPECT_EQ(checker.check({0.25, 0.25}, {Kind::share_within, 1.25}, WeighBy::area).reason, "");
    EXPECT_NE(checker.check({1.3, 1.4}, {Kind::mean}, WeighBy::area).reason, "");
}

TEST(VerifyStatistics, AMeshWithoutAreaIsNotChecked) {
    const Shape line = soup(rows({{0, 0, 1}, {0, 0, 1.5}, {0, 0, 2.5}}));
    StatisticsChecker checker(line, {}, plane, {});
    EXPECT_EQ(checker.check({1, 2.5}, {Kind::mean}, WeighBy::area).lower, Verdict::not_checked);
    EXPECT_EQ(checker.check({5.0 / 3, 5.0 / 3}, {Kind::mean}, WeighBy::number).reason, "");
    EXPECT_NE(checker.check({1.5, 1.6}, {Kind::mean}, WeighBy::number).reason, "");
}

}  // namespace
}  // namespace hausbench
