// The exact solvers of point sets against exact arithmetic and each other, on many small scenes; and proof that the
// published errors kept by some solvers are errors.
#include "algorithms/peers/checked_result.h"
#include "algorithms/points/exact.h"
#include "algorithms/points/shuffle.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/reference.h"
#include "tests/support/scenes.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <set>

namespace hausbench {
namespace {

// Returns random points, some of them moved onto a grid, a line, a plane, one point, or each other.
Points small_set(Random& random, Index most) {
    Points points = cloud(random, 1 + random.below(most), std::pow(2.0, -random.below(8)));
    switch (random.below(7)) {
        case 0:
            points = points.unaryExpr([](double x) { return std::round(4 * x) / 4; }).eval();
            break;
        case 1:
            points = (points.col(0) * Vec3(1, 0.1, -0.3).transpose()).eval();
            break;
        case 2:
            points.col(random.below(3)).setConstant(0.125);
            break;
        case 3:
            points.rowwise() = Vec3(random.vector()).transpose().eval();
            break;
        case 4:
            for (Index i = 0; i < points.rows(); ++i)
                points.row(i) = points.row(random.below(static_cast<Index>(points.rows()))).eval();
            break;
        default:
            break;
    }
    if (random.below(3) == 0) points.rowwise() += random.vector(4).transpose();
    return points;
}

struct SmallScene {
    Scene scene;
    Pose pose;
};

SmallScene small_scene(Random& random, Index most) {
    Points a = small_set(random, most), b = small_set(random, most);
    for (Index i = 0; i < a.rows(); ++i) {  // common points, and nearly common ones
        if (random.below(4) == 0) a.row(i) = b.row(random.below(static_cast<Index>(b.rows())));
        if (random.below(16) == 0) a.row(i) += random.vector(1e-12).transpose();
    }
    SmallScene small{{PointSet{a}, PointSet{b}}, {}};
    if (random.below(3) == 0) small.pose = turned(0.6, 0.8, random.vector());
    if (random.below(6) == 0) small.pose.translation = random.vector(8);
    return small;
}

Result answer(const SolverEntry& entry, const SmallScene& small, const ParameterMap& given = {}) {
    const Session session(entry, Options(entry.info.name, entry.info.parameters, given), small.scene,
                          {.moves = !small.pose.is_identity(), .count = 1, .finest_tolerance = 1e-6});
    Query query;
    query.source_pose = small.pose;
    query.tolerance = {Tolerance::Of::absolute, 1e-6};
    Trace trace;
    return session.solve(query, trace);
}

TEST(PointSolvers, AgreeToTheBitOnTenThousandScenes) {
    std::vector<const SolverEntry*> exact_solvers;
    for (const SolverEntry& entry : solvers()) {
        if (entry.info.ignores_tolerance && entry.info.certified && entry.info.source.points &&
            !entry.info.source.mesh && entry.info.target.points)
            exact_solvers.push_back(&entry);
    }
    ASSERT_GE(exact_solvers.size(), 6u);
    Random random(41);
    std::map<std::string, int> chosen;
    for (int i = 0; i < 10'000; ++i) {
        const SmallScene small = small_scene(random, 14);
        const Points a = posed(points_of(small.scene.source), small.pose);
        const exact::Rational squared = exact_squared_hausdorff(a, points_of(small.scene.target));
        const Result naive = answer(find_solver("naive"), small);
        for (const SolverEntry* entry : exact_solvers) {
            ParameterMap given;
            if (entry->info.name == "ohd") given["lambda"] = 0.25;  // by default the sample is a single point
            const Result result = answer(*entry, small, given);
            const std::string where = entry->info.name + " on scene " + std::to_string(i);
            const exact::Rational low = result.bounds.lower, high = result.bounds.upper;
            ASSERT_TRUE(low * low <= squared && squared <= high * high) << where;
            ASSERT_EQ(result.bounds.lower, naive.bounds.lower) << where;
            ASSERT_EQ(result.bounds.upper, naive.bounds.upper) << where;
            ASSERT_GE(result.witness.source_element, 0) << where;
            if (entry->info.name == "adaptive") ++chosen[std::get<std::string>(result.reported.at("chosen"))];
        }
    }
    for (const char* choice : {"nohd", "earlybreak", "ohd"})
        EXPECT_GT(chosen[choice], 500) << "the framework hardly ever chose " << choice;
}

// Two samples of a curve: the point of B that ended the last scan is near the next point of A. EARLYBREAK looks at random
// points of B; without an order of the sets, so does LSS.
TEST(PointSolvers, LocalStartSearchStartsNearTheLastBreak) {
    Random random(5);
    constexpr Index count = 4000;
    Points a(count, 3), b(count, 3);
    for (Points* points : {&a, &b}) {
        for (Index i = 0; i < count; ++i) {
            const double t = 6.283 * random.unit();
            points->row(i) = Vec3(std::cos(t), std::sin(t), std::sin(3 * t)).transpose();
        }
    }
    const SmallScene small{{PointSet{a}, PointSet{b}}, {}};
    const std::uint64_t local = answer(find_solver("lss"), small).counters.point_distances,
                        unsorted = answer(find_solver("lss"), small, {{"sort", false}}).counters.point_distances,
                        early = answer(find_solver("earlybreak"), small).counters.point_distances;
    EXPECT_LT(10 * local, early);
    EXPECT_LT(10 * local, unsorted);
}

// The point of B at 0.75 prevents the session from enlarging the scene, so the other squared distance underflows.
TEST(PointSolvers, BoundsHoldWhereSquaresUnderflow) {
    for (const double apart : {1e-200, 0x1p-537 * 0.75, 0x1p-537 * 1.25, 0x1p-537 * 1.2, 0x1p-530 * 1.1, 1e-100}) {
        const SmallScene small{{PointSet{rows({{0, 0, 0}})}, PointSet{rows({{apart, 0, 0}, {0.75, 0, 0}})}}, {}};
        for (const SolverEntry& entry : solvers()) {
            if (!entry.info.ignores_tolerance || !entry.info.certified || !entry.info.source.points) continue;
            const Result result = answer(entry, small);
            EXPECT_LE(result.bounds.lower, apart) << entry.info.name;
            EXPECT_GE(result.bounds.upper, apart) << entry.info.name;
        }
    }
}

// Simulates a search that missed the nearest point of B, and one that stopped before the third point of A.
TEST(PointSolvers, CheckedResultHoldsWhereASearchMissedTheNearestPoint) {
    const Points a = rows({{0, 0, 0}, {3, 0, 0}, {9, 0, 0}}), b = rows({{8, 0, 0}, {1, 0, 0}, {0, 0, 0}});
    const FarthestPoint missed{.squared = 25, .source = 1, .target = 0};  // the nearest distance is 2
    const Result ended = checked_result({}, a, b, missed, {});
    EXPECT_NEAR(ended.bounds.lower, 2, 1e-12);
    EXPECT_NEAR(ended.bounds.upper, 5, 1e-12);
    EXPECT_EQ(ended.witness.source_element, 1);
    EXPECT_EQ(ended.witness.target_element, 1);
    EXPECT_EQ(ended.counters.point_distances, 3U);
    const Result stopped = checked_result({}, a, b, missed, {}, 36, Status::budget);
    EXPECT_NEAR(stopped.bounds.upper, 6, 1e-12);
    EXPECT_EQ(stopped.status, Status::budget);
    const Result nothing = checked_result({}, a, b, {}, {}, 81, Status::time_limit);
    EXPECT_EQ(nothing.bounds.lower, 0);
    EXPECT_EQ(nothing.witness.source_element, -1);
}

// Larger sets, on which cells are culled and queues grow, must give the bits of the naive solver, checked above.
TEST(PointSolvers, AgreeToTheBitOnLargerScenes) {
    Random random(42);
    double culled = 0;
    for (int i = 0; i < 150; ++i) {
        const SmallScene small = small_scene(random, 600);
        const Result naive = answer(find_solver("naive"), small);
        const auto check = [&](const char* name, const ParameterMap& given) {
            const Result result = answer(find_solver(name), small, given);
            EXPECT_EQ(result.bounds.lower, naive.bounds.lower) << name << " on scene " << i;
            EXPECT_EQ(result.bounds.upper, naive.bounds.upper) << name << " on scene " << i;
            return result;
        };
        check("inc", {});
        for (const std::int64_t depth : {0, 2, 6, 12}) {
            check("nohd", {{"depth", depth}});
            check("nohd", {{"depth", depth}, {"build", std::string("to_depth")}});
        }
        check("nohd", {{"early_break", false}});
        check("ohd", {{"culling", std::string("none")}});
        culled += std::get<double>(check("ohd", {}).reported.at("culled"));
        check("adaptive", {});
    }
    EXPECT_GT(culled, 1000);
}

// A solver that keeps a published error must never be certified, and must be shown to be wrong.
TEST(PointSolvers, PublishedErrorsAreErrors) {
    for (const SolverEntry& entry : solvers()) {
        if (entry.info.known_wrong.empty()) continue;
        EXPECT_FALSE(entry.info.certified) << entry.info.name;
        Random random(43);
        int wrong = 0;
        for (int i = 0; i < 400; ++i) {
            const SmallScene small{{PointSet{cloud(random, 400)}, PointSet{cloud(random, 400)}}, {}};
            const Result naive = answer(find_solver("naive"), small);
            const Result result = answer(
                entry, small, entry.info.name == "ohd_as_printed" ? ParameterMap{{"lambda", 0.05}} : ParameterMap{});
            wrong += result.bounds.lower > naive.bounds.upper || result.bounds.upper < naive.bounds.lower;
        }
        EXPECT_GT(wrong, 0) << entry.info.name;
        RecordProperty(entry.info.name, wrong);
        std::cout << entry.info.name << ": " << wrong << " of 400 wrong\n";
    }
}

TEST(PointSolvers, OhdWithTheCullingAsPrintedIsNotCertified) {
    const SolverEntry& ohd = find_solver("ohd");
    const auto certified = [&](const ParameterMap& given) {
        return ohd.make(Options("ohd", ohd.info.parameters, given))->certified();
    };
    EXPECT_TRUE(certified({}));
    EXPECT_TRUE(certified({{"culling", "none"}}));
    EXPECT_FALSE(certified({{"culling", "as_printed"}}));
}

// Returns the result of the paper's printed culling. AHD is the distance of the first points of A in random order; a
// point of A is skipped if its grid cell of side AHD contains a point of B.
double squared_by_printed_culling(const Points& a, const Points& b, double lambda, std::uint64_t seed) {
    const auto nearest = [&](Index i) {
        double least = std::numeric_limits<double>::infinity();
        for (Index j = 0; j < b.rows(); ++j)
            least = std::min(least, squared_distance(a.row(i).data(), b.row(j).data()));
        return least;
    };
    Generator generator(seed);
    const std::vector<Index> order = order_of(static_cast<Index>(a.rows()), true, generator);
    double most = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(std::ceil(lambda * static_cast<double>(a.rows()))); ++k)
        most = std::max(most, nearest(order[k]));
    const double side = std::sqrt(most);
    const Vec3 low = b.colwise().minCoeff();
    const auto cell = [&](const Points& points, Index i) {
        std::array<double, 3> key;
        for (Index k = 0; k < 3; ++k) key[static_cast<std::size_t>(k)] = std::floor((points(i, k) - low[k]) / side);
        return key;
    };
    std::set<std::array<double, 3>> occupied;
    for (Index j = 0; j < b.rows(); ++j) occupied.insert(cell(b, j));
    for (Index i = 0; i < a.rows(); ++i)
        if (!occupied.contains(cell(a, i))) most = std::max(most, nearest(i));
    return most;
}

TEST(PointSolvers, OhdAsPrintedGivesWhatThePaperSays) {
    Random random(47);
    int wrong = 0;
    for (int i = 0; i < 200; ++i) {
        const SmallScene small{{PointSet{cloud(random, 400)}, PointSet{cloud(random, 400)}}, {}};
        const double expected =
            squared_by_printed_culling(points_of(small.scene.source), points_of(small.scene.target), 0.05, 1);
        for (const Result& result :
             {answer(find_solver("ohd_as_printed"), small, {{"lambda", 0.05}}),
              answer(find_solver("ohd"), small, {{"culling", "as_printed"}, {"lambda", 0.05}})}) {
            EXPECT_EQ(result.bounds.lower, distance_at_least(expected, false)) << i;
            EXPECT_EQ(result.bounds.upper, distance_at_most(expected, false)) << i;
        }
        wrong += answer(find_solver("naive"), small).bounds.lower > distance_at_most(expected, false);
    }
    EXPECT_GT(wrong, 0);
}

// Without early breaking, Algorithm 4 inserts every cell of a split into the queue.
TEST(PointSolvers, NohdWithoutEarlyBreakInsertsEveryChild) {
    Random random(48);
    for (int i = 0; i < 20; ++i) {
        const SmallScene small{{PointSet{cloud(random, 400)}, PointSet{cloud(random, 400)}}, {}};
        const Counters with = answer(find_solver("nohd"), small).counters;
        const Counters without = answer(find_solver("nohd"), small, {{"early_break", false}}).counters;
        EXPECT_EQ(without.queue_pushes, without.node_visits);
        EXPECT_EQ(without.bound_tests, without.node_visits * 400) << "each child against all of B";
        EXPECT_LT(with.queue_pushes, with.node_visits);
    }
}

// The first bound, AHD (section 4.4.1), takes ceil(lambda * |A|) points of A with early breaking: far fewer distances
// than without.
TEST(PointSolvers, OhdTakesItsFirstBoundByEarlyBreak) {
    Random random(49);
    const SmallScene small{{PointSet{cloud(random, 600)}, PointSet{cloud(random, 600)}}, {}};
    const auto queries = [&](double lambda, std::uint64_t budget) {
        const SolverEntry& ohd = find_solver("ohd");
        const Session session(ohd, Options("ohd", ohd.info.parameters, {{"lambda", lambda}, {"culling", "none"}}),
                              small.scene, {});
        Query query;
        query.tolerance = {Tolerance::Of::absolute, 1e-6};
        query.budget = budget;
        Trace trace;
        return session.solve(query, trace).counters;
    };
    const Counters sampled = queries(0.5, 300);  // stops after the sample
    EXPECT_EQ(sampled.closest_point_queries, 0U);
    EXPECT_EQ(sampled.node_visits, 0U);
    EXPECT_GT(sampled.point_distances, 600U);                        // the first outer loop visits all of B
    EXPECT_LT(sampled.point_distances, 300U * 600U / 4);             // most break early
    EXPECT_EQ(queries(0.5, 1'000'000).closest_point_queries, 600U);  // then every point of A is queried
}

}  // namespace
}  // namespace hausbench
