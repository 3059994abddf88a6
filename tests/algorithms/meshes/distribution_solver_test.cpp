// The solver `distribution` through a session: units, motion, point sets, weights, and both directions together.
#include "algorithms/error.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using Kind = Statistic::Kind;
using Over = Statistic::Over;

Query query_of(std::vector<Statistic> statistics, double tolerance = 1e-4) {
    Query query;
    query.quantity = Quantity::distribution;
    query.statistics = std::move(statistics);
    query.tolerance = {Tolerance::Of::absolute, tolerance};
    query.share_tolerance = 1e-3;
    return query;
}

Result answer(const Scene& scene, const Query& query, const QuerySet& queries = {}) {
    const SolverEntry& entry = find_solver("distribution");
    const Session session(entry, Options("distribution", entry.info.parameters, {}), scene, queries);
    Trace untraced;
    return session.solve(query, untraced);
}

Bounds bounds_of(const Scene& scene, const Statistic& statistic) {
    const Result result = answer(scene, query_of({statistic}));
    EXPECT_EQ(result.status, Status::converged) << to_string(statistic) << ": " << result.note;
    return result.statistics.at(0);
}

void expect_around(const Bounds& bounds, double value) {
    EXPECT_LE(bounds.lower, value * (1 + 1e-15));
    EXPECT_GE(bounds.upper, value * (1 - 1e-15));
}

const std::vector<Statistic> some = {
    {Kind::mean}, {Kind::rms}, {Kind::deviation}, {Kind::maximum}, {Kind::quantile, 0.75}};

// A flat square at height 1 above a larger one, and a square half as wide at height 3.
Scene two_plates() {
    TriangleMesh a = sheet(2, 1);
    TriangleMesh b = sheet(5, 0);
    b.vertices.leftCols(2).array() -= 1.5;
    return {a, b};
}

TEST(DistributionSolver, NamesAreReadAsTheyAreWritten) {
    for (const char* text : {"mean", "rms", "deviation", "maximum", "median", "quantile 0.95", "within 0.1",
                             "mean target", "median larger", "within 1e-300 harmonic_mean", "rms pooled"})
        EXPECT_EQ(to_string(statistic_of(text)), text);
    EXPECT_EQ(statistic_of("quantile 0.5"), statistic_of(" median "));
    for (const char* text : {"", "average", "quantile", "quantile x", "quantile 0", "quantile 1.5", "quantile nan",
                             "within", "within -1", "within inf", "mean both", "mean pooled pooled", "within 0.1mm"})
        EXPECT_THROW((void)statistic_of(text), InputError) << text;
}

TEST(DistributionSolver, ThePowerOfTwoOfTheUnitDoesNotMatter) {
    const TriangleMesh a = sheet(4, 0.5, 0.2), b = sheet(5, 0, 0.1);
    std::vector<Statistic> all = some;
    all.push_back({Kind::share_within, 0.5});
    const Result at_one = answer({a, b}, query_of(all));
    for (const int exponent : {-1000, -340, 340, 1000}) {
        const double scale = std::ldexp(1.0, exponent);
        TriangleMesh c = a, d = b;
        c.vertices *= scale;
        d.vertices *= scale;
        Query query = query_of(all, 1e-4 * scale);
        query.statistics.back().argument *= scale;
        const Result there = answer({c, d}, query);
        EXPECT_EQ(there.status, Status::converged);
        for (std::size_t i = 0; i < all.size(); ++i) {
            const double unit = is_share(all[i]) ? 1 : scale;
            EXPECT_EQ(there.statistics[i].lower, at_one.statistics[i].lower * unit) << i;
            EXPECT_EQ(there.statistics[i].upper, at_one.statistics[i].upper * unit) << i;
        }
        EXPECT_EQ(there.bounds.lower, there.statistics[0].lower);
    }
}

// Shows bounds from the boxes first, then the bounds of each round.
TEST(DistributionSolver, ShowsBoundsInTheUnitOfTheInputFromTheBeginning) {
    TriangleMesh a = sheet(4, 0.5, 0.2), b = sheet(5, 0, 0.1);
    a.vertices *= 1e5;
    b.vertices *= 1e5;
    std::vector<Statistic> all = some;
    all.push_back({Kind::share_within, 5e4});
    Query query = query_of(all, 1);
    const Result result = answer({a, b}, query);
    const SolverEntry& entry = find_solver("distribution");
    const Session session(entry, Options("distribution", entry.info.parameters, {}), {a, b}, {});
    Trace trace;
    std::vector<std::vector<Bounds>> seen;
    trace.watch([&](Result& so_far) { seen.push_back(so_far.statistics); });
    EXPECT_EQ(session.solve(query, trace).bounds.upper, result.bounds.upper);
    ASSERT_GE(seen.size(), 3u);
    for (std::size_t i = 0; i < all.size(); ++i) {
        for (const std::vector<Bounds>& shown : seen) {
            ASSERT_EQ(shown.size(), all.size());
            EXPECT_LE(shown[i].lower, result.statistics[i].upper) << i;
            EXPECT_GE(shown[i].upper, result.statistics[i].lower) << i;
        }
        EXPECT_LE(seen.front()[i].upper, is_share(all[i]) ? 1 : 1e6) << i;
        EXPECT_GE(seen.front()[i].upper, is_share(all[i]) ? 1 : 1e5) << i;
        EXPECT_LT(seen.back()[i].upper - seen.back()[i].lower, 1.01) << i;
    }
    query.time_limit = 0;
    const Result none = answer({a, b}, query);
    EXPECT_EQ(none.status, Status::time_limit);
    for (const Bounds& bounds : none.statistics) EXPECT_LT(bounds.upper, 1e6);
}

// Coordinates that differ by more than doubles can hold are rounded when they are scaled, and areas with them.
TEST(DistributionSolver, ShapesThatScalingChangesHaveOnlyTrivialBounds) {
    TriangleMesh a = sheet(3, 1);
    a.vertices *= 1e-310;
    TriangleMesh b = sheet(3, 0);
    b.vertices *= 1e300;
    const Result result = answer({a, b}, query_of({{Kind::mean}, {Kind::share_within, 1}}));
    EXPECT_EQ(result.status, Status::precision_floor);
    EXPECT_EQ(result.statistics[0].lower, 0);
    EXPECT_EQ(result.statistics[0].upper, infinity);
    EXPECT_EQ(result.statistics[1].upper, 1);
    // A length that scaling rounds.
    TriangleMesh far = b;
    far.vertices.col(2).setConstant(1e299);
    const Result tiny = answer({far, b}, query_of({{Kind::share_within, 1e-300}}));
    EXPECT_EQ(tiny.status, Status::precision_floor);
    EXPECT_EQ(tiny.statistics[0].lower, 0);
    EXPECT_EQ(tiny.statistics[0].upper, 1);
}

TEST(DistributionSolver, AMotionIsTheSameAsMovedCopies) {
    Random random(5);
    const TriangleMesh a = sheet(4, 0.5, 0.2), b = sheet(5, 0, 0.1);
    const std::vector<Statistic> all = {{Kind::mean}, {Kind::rms, 0, Over::target}, {Kind::maximum, 0, Over::pooled}};
    for (int i = 0; i < 4; ++i) {
        Query query = query_of(all);
        const Eigen::AngleAxisd turn(random.real(-3, 3), random.vector().normalized());
        query.source_pose = {turn.toRotationMatrix(), random.vector()};
        if (i % 2 == 1) query.target_pose = {Eigen::Matrix3d(turn.toRotationMatrix() * 1.5), random.vector()};
        QuerySet queries;
        queries.moves = queries.target_moves = queries.both_ways = true;
        const Result moved = answer({a, b}, query, queries);
        TriangleMesh c = a, d = b;
        c.vertices = posed(a.vertices, query.source_pose);
        d.vertices = posed(b.vertices, query.target_pose);
        const Result copied = answer({c, d}, query_of(all));
        EXPECT_EQ(moved.status, Status::converged);
        for (std::size_t k = 0; k < all.size(); ++k) {
            EXPECT_LE(moved.statistics[k].lower, copied.statistics[k].upper);
            EXPECT_GE(moved.statistics[k].upper, copied.statistics[k].lower);
        }
    }
}

TEST(DistributionSolver, BothDirections) {
    const Scene scene = two_plates();  // d(a,B) = 1; d(b,A) grows toward the border of B
    Random random(8);
    const Scene bumpy{sheet(4, 0.5, 0.2), sheet(5, 0, 0.1)};
    for (const Scene& each : {scene, bumpy}) {
        for (const Statistic& of :
             std::vector<Statistic>{{Kind::mean}, {Kind::quantile, 0.9}, {Kind::share_within, 1.1}}) {
            std::map<Over, Bounds> bounds;
            for (const Over over : all_overs) {
                Statistic statistic = of;
                statistic.over = over;
                bounds[over] = bounds_of(each, statistic);
            }
            const Bounds s = bounds[Over::source], t = bounds[Over::target];
            const auto expect = [&](Over over, double lower, double upper) {
                EXPECT_LE(bounds[over].lower, upper * (1 + 1e-15)) << to_string(over);
                EXPECT_GE(bounds[over].upper, lower * (1 - 1e-15)) << to_string(over);
            };
            expect(Over::larger, std::max(s.lower, t.lower), std::max(s.upper, t.upper));
            expect(Over::mean_of_both, (s.lower + t.lower) / 2, (s.upper + t.upper) / 2);
            expect(Over::harmonic_mean, 2 * s.lower * t.lower / (s.lower + t.lower),
                   2 * s.upper * t.upper / (s.upper + t.upper));
            // Pooled values lie between the two.
            expect(Over::pooled, std::min(s.lower, t.lower), std::max(s.upper, t.upper));
        }
    }
    // The areas are 1 and 16, so pooled = (1 * source + 16 * target) / 17.
    const Bounds target = bounds_of(scene, {Kind::mean, 0, Over::target}),
                 pooled = bounds_of(scene, {Kind::mean, 0, Over::pooled});
    EXPECT_LE(pooled.lower, (1 + 16 * target.upper) / 17 + 1e-15);
    EXPECT_GE(pooled.upper, (1 + 16 * target.lower) / 17 - 1e-15);
}

// The example of docs/conventions.md: a plate of area 100, and the same plate with a piece of area 10 that is 5 above it.
TEST(DistributionSolver, TwoMeaningsOfHd95) {
    const auto plate = [](double x, double y, double z) {
        return std::vector<Vec3>{{0, 0, z}, {x, 0, z}, {x, y, z}, {0, 0, z}, {x, y, z}, {0, y, z}};
    };
    const auto mesh = [](const std::vector<Vec3>& corners) {
        Points points(Index(corners.size()), 3);
        for (std::size_t i = 0; i < corners.size(); ++i) points.row(Index(i)) = corners[i];
        return soup(points);
    };
    std::vector<Vec3> both = plate(10, 10, 0);
    for (const Vec3& v : plate(5, 2, 5)) both.push_back(v);
    const Scene scene{mesh(plate(10, 10, 0)), mesh(both)};
    expect_around(bounds_of(scene, {Kind::quantile, 0.95, Over::source}), 0);
    expect_around(bounds_of(scene, {Kind::quantile, 0.95, Over::target}), 5);
    expect_around(bounds_of(scene, {Kind::quantile, 0.95, Over::larger}), 5);
    expect_around(bounds_of(scene, {Kind::quantile, 0.95, Over::pooled}), 0);
    expect_around(bounds_of(scene, {Kind::mean, 0, Over::target}), 50.0 / 110);
    expect_around(bounds_of(scene, {Kind::mean, 0, Over::pooled}), 50.0 / 210);
    expect_around(bounds_of(scene, {Kind::share_within, 1, Over::pooled}), 200.0 / 210);  // surface Dice
}

TEST(DistributionSolver, AreaAndNumber) {
    // Nine vertices on a sheet that lies on B, and one that a needle carries far away.
    TriangleMesh a = sheet(3, 0);
    a.vertices.conservativeResize(11, 3);
    a.vertices.row(9) = Vec3(0, 0, 10);
    a.vertices.row(10) = Vec3(0, 0, 77);  // belongs to no triangle
    a.triangles.conservativeResize(9, 3);
    a.triangles.row(8) << 0, 1, 9;
    const TriangleMesh b = sheet(9, 0);
    Query query = query_of({{Kind::mean}, {Kind::maximum}, {Kind::share_within, 1e-9}});
    const Result area = answer({a, b}, query);
    expect_around(area.statistics[0],
                  5 * (10.0 / 3) / 9);  // 4 of area 0 high, 5 of a triangle with the corners 0, 0, 10
    query.weigh = WeighBy::number;
    const Result number = answer({a, b}, query);
    expect_around(number.statistics[0], 1);
    expect_around(number.statistics[1], 10);
    expect_around(number.statistics[2], 0.9);
}

TEST(DistributionSolver, PointsAndMeshes) {
    const PointSet points{rows({{0, 0, 1}, {1, 1, 2}, {2, 2, 6}})};
    const TriangleMesh mesh = sheet(3, 0);
    const Result result =
        answer({points, mesh}, query_of({{Kind::mean}, {Kind::quantile, 0.5}, {Kind::mean, 0, Over::larger}}));
    expect_around(result.statistics[0], 3);
    expect_around(result.statistics[1], 2);
    EXPECT_GE(result.statistics[2].upper, 3);
    EXPECT_THROW(answer({points, mesh}, query_of({{Kind::mean, 0, Over::pooled}})), InputError);
    Query query = query_of({{Kind::mean, 0, Over::pooled}});
    query.weigh = WeighBy::number;
    EXPECT_EQ(answer({points, mesh}, query).status, Status::converged);
    expect_around(bounds_of({points, points}, {Kind::mean, 0, Over::pooled}), 0);
}

// Voxels have many equal distances, and lengths that are exactly a distance.
TEST(DistributionSolver, TiesOfPointsAreExact) {
    std::vector<std::array<double, 3>> a, b;
    for (const double x : {0.0, 1.0, 2.0, 3.0})
        for (const double y : {0.0, 1.0, 2.0, 3.0, 4.0}) a.push_back({x, y, 0});
    for (const double y : {0.0, 1.0, 2.0, 3.0, 4.0}) b.push_back({0, y, 0});
    b.push_back({4, 4, 1});  // the root of 2 from (3, 4, 0)
    const auto set = [](const std::vector<std::array<double, 3>>& points, double unit) {
        PointSet made{Points(Index(points.size()), 3)};
        for (std::size_t i = 0; i < points.size(); ++i)
            made.points.row(Index(i)) = unit * Vec3(points[i][0], points[i][1], points[i][2]);
        return made;
    };
    // The distances: 0, 1 and 2 five times each, 3 twice, and the roots of 2, 3 and 6.
    for (const double unit : {1.0, 0x1p-700}) {
        const Scene scene{set(a, unit), set(b, unit)};
        const auto exactly = [&](const Statistic& statistic, double value) {
            const Bounds bounds = bounds_of(scene, statistic);
            EXPECT_LE(bounds.lower, value) << to_string(statistic);
            EXPECT_GE(bounds.upper, value) << to_string(statistic);
            EXPECT_LE(bounds.gap(), 0x1p-52 * (is_share(statistic) ? 1 : value)) << to_string(statistic);
        };
        exactly({Kind::share_within, 1 * unit}, 10.0 / 20);
        exactly({Kind::share_within, 0}, 5.0 / 20);
        exactly({Kind::quantile, 0.5}, 1 * unit);
        EXPECT_LE(bounds_of(scene, {Kind::quantile, 0.25}).upper, 0x1p-60 * unit);
        exactly({Kind::share_within, std::sqrt(2.0) * unit}, 11.0 / 20);  // the double is above the root of 2
        exactly({Kind::share_within, 2 * unit}, 17.0 / 20);
        exactly({Kind::quantile, 0.85}, 2 * unit);
        exactly({Kind::maximum}, 3 * unit);
        EXPECT_LT(bounds_of(scene, {Kind::share_within, std::sqrt(2.0) * unit}).lower,
                  11.0 / 20);  // a double above 11/20
    }
}

TEST(DistributionSolver, AMeshWithoutAnyAreaIsBetweenItsLeastAndGreatestDistance) {
    const TriangleMesh line = soup(rows({{0, 0, 1}, {0, 0, 1.25}, {0, 0, 2}}));
    const Result result =
        answer({line, sheet(2, 0)}, query_of({{Kind::mean}, {Kind::deviation}, {Kind::share_within, 1}}));
    EXPECT_EQ(result.status, Status::precision_floor);
    EXPECT_NEAR(result.statistics[0].lower, 1, 1e-9);
    EXPECT_NEAR(result.statistics[0].upper, 2, 1e-9);
    EXPECT_GE(result.statistics[1].upper, 0.5);
    EXPECT_LE(result.statistics[1].upper, 2);
    EXPECT_EQ(result.statistics[2].lower, 0);
    EXPECT_EQ(result.statistics[2].upper, 1);
}

TEST(DistributionSolver, ARelativeToleranceIsThatOfEachStatistic) {
    const Scene scene{sheet(4, 0.5, 0.2), sheet(5, 0, 0.1)};
    Query query = query_of({{Kind::mean}, {Kind::deviation}, {Kind::mean, 0, Over::larger}});
    query.tolerance = {Tolerance::Of::lower, 1e-3};
    const Result result = answer(scene, query);
    EXPECT_EQ(result.status, Status::converged);
    for (const Bounds& bounds : result.statistics) EXPECT_LE(bounds.gap(), 1e-3 * bounds.lower);
}

TEST(DistributionSolver, WrongQueriesAreRefused) {
    const Scene scene = two_plates();
    EXPECT_THROW(answer(scene, query_of({})), InputError);
    Query query = query_of({{Kind::share_within, 1}});
    query.share_tolerance = 0;
    EXPECT_THROW(answer(scene, query), InputError);
    query.quantity = Quantity::directed;
    EXPECT_THROW(answer(scene, query), InputError);
    EXPECT_NE(refusal(find_solver("cover").info, ShapeKind::mesh, ShapeKind::mesh, Quantity::distribution), "");
}

// A path of segments along the x axis, of very different lengths; b is where it begins.
Scene path_and_point(std::vector<double> ends) {
    TriangleMesh path;
    path.vertices = Points::Zero(static_cast<Eigen::Index>(ends.size()), 3);
    path.triangles.resize(static_cast<Eigen::Index>(ends.size()) - 1, 3);
    for (Index i = 0; i < path.vertices.rows(); ++i) path.vertices(i, 0) = ends[static_cast<std::size_t>(i)];
    for (Index i = 0; i + 1 < path.vertices.rows(); ++i) {
        if (i % 2 == 0)
            path.triangles.row(i) << i, i + 1, i + 1;
        else
            path.triangles.row(i) << i, i, i + 1;
    }
    return {path, PointSet{Points::Zero(1, 3)}};
}

TEST(DistributionSolver, SegmentsAloneCountByLength) {
    const Scene scene = path_and_point({0, 0.125, 1, 3});
    expect_around(bounds_of(scene, {Kind::mean}), 1.5);
    expect_around(bounds_of(scene, {Kind::rms}), std::sqrt(3.0));
    expect_around(bounds_of(scene, {Kind::deviation}), std::sqrt(0.75));
    expect_around(bounds_of(scene, {Kind::quantile, 0.75}), 2.25);
    expect_around(bounds_of(scene, {Kind::share_within, 1}), 1.0 / 3);
    expect_around(bounds_of(scene, {Kind::share_within, 0.0625}), 0.0625 / 3);
    expect_around(bounds_of(scene, {Kind::mean, 0, Over::mean_of_both}), 0.75);
    EXPECT_EQ(answer(scene, query_of({{Kind::maximum}})).witness.source_element, 2);
    const Scene lengths = path_and_point({0, 1e-12, 1});  // a short segment counts little
    expect_around(bounds_of(lengths, {Kind::mean}), 0.5);
}

TEST(DistributionSolver, ATriangleMakesSegmentsCountNothing) {
    TriangleMesh both;
    both.vertices.resize(5, 3);
    both.vertices << 0, 0, 1, 1, 0, 1, 0, 1, 1, 0, 0, 9, 1, 0, 9;
    both.triangles.resize(2, 3);
    both.triangles << 0, 1, 2, 3, 4, 4;
    TriangleMesh floor = sheet(4, 0);
    floor.vertices *= 10;
    EXPECT_EQ(counted_by(both), CountedBy::area);
    expect_around(bounds_of({both, floor}, {Kind::mean}), 1);
    expect_around(bounds_of({both, floor}, {Kind::maximum}), 9);
}

TEST(DistributionSolver, WhatIsCountedByAreaLengthOrNumber) {
    TriangleMesh dot;
    dot.vertices = Points::Zero(1, 3);
    dot.triangles = Triangles::Zero(1, 3);
    EXPECT_EQ(counted_by(dot), CountedBy::nothing);
    const Scene scene{dot, sheet(2, 1)};
    expect_around(answer(scene, query_of({{Kind::mean}})).statistics[0], 1);  // whatever it weighs
    Query by_number = query_of({{Kind::mean}});
    by_number.weigh = WeighBy::number;
    expect_around(answer(scene, by_number).statistics[0], 1);
    EXPECT_THROW(bounds_of({path_and_point({0, 1}).source, sheet(2, 1)}, {Kind::mean, 0, Over::pooled}), InputError);
    const Scene lines{path_and_point({0, 1}).source, path_and_point({0, 2}).source};
    expect_around(bounds_of(lines, {Kind::mean, 0, Over::pooled}), 0.5 / 3);
}

}  // namespace
}  // namespace hausbench
