// The solver scan must give the bits of naive on many scenes; then its parts, one by one.
#include "algorithms/kernel/morton.h"
#include "algorithms/points/scan/cells.h"
#include "algorithms/points/scan/near_grid.h"
#include "algorithms/points/scan/passes.h"
#include "algorithms/points/scan/point_blocks.h"
#include "algorithms/points/scan/point_cells.h"
#include "algorithms/points/scan/search.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/exact.h"
#include "tests/support/process_threads.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"

#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <sched.h>

namespace hausbench {
namespace {

using namespace scan;

Points shuffled(Random& random, Points points) {
    for (auto i = static_cast<Index>(points.rows()); i > 1; --i) points.row(i - 1).swap(points.row(random.below(i)));
    return points;
}

Points noisy(Random& random, Points points, double size) {
    for (Index i = 0; i < points.rows(); ++i) points.row(i) += random.vector(size).transpose();
    return points;
}

Points stacked(const Points& a, const Points& b) {
    Points both(a.rows() + b.rows(), 3);
    both << a, b;
    return both;
}

Points sphere(Random& random, Index count) {
    Points points = cloud(random, count);
    points.rowwise().normalize();
    return points;
}

// Returns points at distances of about 2^-k from the origin, for many k, so that no single grid resolves them.
Points at_all_scales(Random& random, Index count, int most) {
    Points points = cloud(random, count);
    for (Index i = 0; i < count; ++i) points.row(i) *= std::ldexp(1.0, -random.below(most));
    return points;
}

Points gridded(const Points& points, double cells) { return (points * cells).array().round() / cells; }

struct Pair {
    std::string name;
    Points a, b;
};

Pair random_pair(Random& random, int kind, Index na, Index nb) {
    const double small = std::pow(10.0, -random.below(9));
    switch (kind) {
        case 0:
            return {"clouds", cloud(random, na), cloud(random, nb)};
        case 1: {
            const Points b = sphere(random, nb);
            return {"the same, shuffled", shuffled(random, b), b};
        }
        case 2: {
            const Points b = sphere(random, nb);
            return {"noise", noisy(random, shuffled(random, b), small), b};
        }
        case 3: {
            const Points some = cloud(random, 1 + nb / 50);
            Points b(nb, 3);
            for (Index j = 0; j < nb; ++j) b.row(j) = some.row(random.below(static_cast<Index>(some.rows())));
            return {"duplicates", noisy(random, b, small), b};
        }
        case 4: {
            const double cells = 1 + random.below(20);
            return {"grids", gridded(cloud(random, na), cells), gridded(cloud(random, nb), cells)};
        }
        case 5: {
            const Vec3 along = random.vector();
            Points a(na, 3), b(nb, 3);
            for (Index i = 0; i < na; ++i) a.row(i) = random.unit() * along;
            for (Index j = 0; j < nb; ++j) b.row(j) = random.unit() * along;
            return {"collinear", a, b};
        }
        case 6:
            return {"one point in A", cloud(random, 1), cloud(random, nb)};
        case 7:
            return {"one point in B", cloud(random, na), cloud(random, 1)};
        case 8: {
            Points a = cloud(random, na);
            a.col(random.below(3)).array() += std::pow(10.0, random.below(16));
            return {"far away", a, cloud(random, nb)};
        }
        case 9:
            return {"huge", cloud(random, na, 1e300), cloud(random, nb, std::pow(10.0, 280 + random.below(28)))};
        case 10:
            return {"tiny", cloud(random, na, 1e-300), cloud(random, nb, std::pow(10.0, -300 - random.below(20)))};
        case 11:
            return {"all scales", at_all_scales(random, na, 60), at_all_scales(random, nb, 1000)};
        case 12: {
            const Points b = sphere(random, nb);
            return {"an outlier", stacked(noisy(random, b, small), cloud(random, 1, 5)), b};
        }
        case 13: {  // the grid sees the cluster as one cell
            const Points b = stacked(cloud(random, nb, 1e-6), rows({{1, 1, 1}, {-1, -1, -1}}));
            return {"cluster", noisy(random, shuffled(random, b), 1e-6 * small), b};
        }
        default: {
            Points a = cloud(random, na), b = cloud(random, nb);
            a.col(2).setZero();
            b.col(2).setZero();
            return {"plane", a, b};
        }
    }
}
constexpr int kinds = 15;

Result answer(const std::string& solver, const Pair& pair, const Pose& pose, const QuerySet& queries = {},
              const ParameterMap& given = {}) {
    const SolverEntry& entry = find_solver(solver);
    const Session session(entry, Options(solver, entry.info.parameters, given),
                          Scene{PointSet{pair.a}, PointSet{pair.b}}, queries);
    Query query;
    query.source_pose = pose;
    query.tolerance.value = 1e-9;
    Trace trace;
    return session.solve(query, trace);
}

void expect_same(const Pair& pair, const Pose& pose, const Result& scan, const std::string& where) {
    const Result naive = answer("naive", pair, pose);
    EXPECT_EQ(scan.bounds.lower, naive.bounds.lower) << where;
    EXPECT_EQ(scan.bounds.upper, naive.bounds.upper) << where;
    EXPECT_EQ(scan.status, naive.status) << where;
    const Vec3 apart = scan.witness.source_point - scan.witness.target_point;
    const Vec3 expected = naive.witness.source_point - naive.witness.target_point;
    if (naive.witness.source_element >= 0 && expected.cwiseAbs().maxCoeff() < 1e150 &&
        expected.cwiseAbs().maxCoeff() > 1e-150) {
        EXPECT_EQ(squared_distance(apart.data(), Vec3(0, 0, 0).data()),
                  squared_distance(expected.data(), Vec3(0, 0, 0).data()))
            << where;
    }
}

// Options that force each method: the tree, the defaults, plain comparisons, cells followed by the tree.
const std::vector<ParameterMap>& variants() {
    constexpr std::int64_t none = 0, many = 1'000'000'000'000;
    static const std::vector<ParameterMap> list = {{{"cells_from", many}, {"tree_from", none}},
                                                   {},
                                                   {{"cells_from", many}, {"tree_from", many}},
                                                   {{"cells_from", none}, {"tree_from", none}}};
    return list;
}

Result with_threads(const Pair& pair, int threads, const ParameterMap& given) {
    const SolverEntry& entry = find_solver("scan");
    QuerySet queries;
    queries.threads = threads;
    const Session session(entry, Options("scan", entry.info.parameters, given),
                          Scene{PointSet{pair.a}, PointSet{pair.b}}, queries);
    Query query;
    query.tolerance.value = 1e-9;
    query.threads = threads;
    Trace trace;
    return session.solve(query, trace);
}

// The first test of this program: later ones start threads, which stay.
TEST(Scan, StartsNoThreadForFewPoints) {
    Random random(45);
    const Pair few{"few", cloud(random, 100'000), cloud(random, 162'143)}, many{"many", few.a, cloud(random, 162'144)};
    const std::ptrdiff_t before = threads_of_process();
    with_threads(few, 2, {});
    EXPECT_EQ(threads_of_process(), before);
    cpu_set_t cores;  // that this process may run on: there may be more
    ASSERT_EQ(::sched_getaffinity(0, sizeof cores, &cores), 0);
    if (CPU_COUNT(&cores) < 2) GTEST_SKIP() << "one core";
    with_threads(many, 2, {});
    EXPECT_GT(threads_of_process(), before);
}

TEST(Scan, SameBitsAsNaiveOnManyScenes) {
    Random random(31);
    for (int i = 0; i < 2000; ++i) {
        const Index most = i % 100 == 0 ? 3000 : i % 10 == 0 ? 700 : 100;
        const Pair pair = random_pair(random, i % kinds, 1 + random.below(most), 1 + random.below(most));
        const std::string where = "scene " + std::to_string(i) + ", " + pair.name;
        const ParameterMap& given = variants()[static_cast<std::size_t>(random.below(4))];
        QuerySet queries;
        queries.moves = random.below(3) == 0;  // if set, the tree is built beforehand
        expect_same(pair, Pose{}, answer("scan", pair, Pose{}, queries, given), where);
    }
}

TEST(Scan, SameBitsAsNaiveAtEveryPose) {
    Random random(32);
    for (int i = 0; i < 150; ++i) {
        const Pair pair = random_pair(random, i % kinds, 1 + random.below(300), 1 + random.below(300));
        const SolverEntry& entry = find_solver("scan");
        QuerySet queries;
        queries.moves = true;
        queries.count = 5;
        const Scene scene{PointSet{pair.a}, PointSet{pair.b}};
        const Session moving(entry, Options("scan", entry.info.parameters, {}), scene, queries);
        const Session once(entry, Options("scan", entry.info.parameters, variants()[i % 2 == 0 ? 0 : 3]), scene, {});
        for (int p = 0; p < 5; ++p) {
            const Pose pose = turned(0.6, 0.8, random.vector(std::pow(10.0, random.below(6) - 3)));
            Query query;
            query.source_pose = pose;
            query.tolerance.value = 1e-9;
            Trace trace;
            const std::string where = "scene " + std::to_string(i) + ", " + pair.name + ", pose " + std::to_string(p);
            expect_same(pair, pose, moving.solve(query, trace), where);
            expect_same(pair, pose, once.solve(query, trace), where + ", tree built while solving");
        }
    }
}

TEST(Scan, SameWorkOnEveryVectorTarget) {
    Random random(33);
    std::vector<Pair> pairs;
    for (int i = 0; i < 3 * kinds; ++i)
        pairs.push_back(random_pair(random, i % kinds, 1 + random.below(900), 1 + random.below(900)));
    std::vector<Result> first;
    std::set<std::int64_t> ran;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        ran.insert(scan_target());
        ASSERT_EQ(scan_target(), target) << "asked for " << hwy::TargetName(target);
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            const Result result = answer("scan", pairs[i], Pose{}, {}, variants()[i % 4]);
            const std::string where = std::string(hwy::TargetName(target)) + ", " + pairs[i].name;
            if (first.size() < pairs.size()) {
                first.push_back(result);
                expect_same(pairs[i], Pose{}, result, where);  // naive has no vector instructions
                continue;
            }
            EXPECT_EQ(result.bounds.lower, first[i].bounds.lower) << where;
            EXPECT_EQ(result.bounds.upper, first[i].bounds.upper) << where;
            EXPECT_EQ(result.witness.source_element, first[i].witness.source_element) << where;
            EXPECT_EQ(result.witness.target_element, first[i].witness.target_element) << where;
            EXPECT_EQ(result.counters, first[i].counters) << where;
        }
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    EXPECT_GE(ran.size(), 2U) << "nothing was compared";
}

TEST(Scan, StopsWithBoundsThatHold) {
    Random random(34);
    const Pair pair = random_pair(random, 2, 0, 5000);
    const Result whole = answer("naive", pair, Pose{});
    const SolverEntry& entry = find_solver("scan");
    for (const ParameterMap& given : variants()) {
        const Session session(entry, Options("scan", entry.info.parameters, given),
                              Scene{PointSet{pair.a}, PointSet{pair.b}}, {});
        for (const std::uint64_t budget : {0, 1, 5, 20}) {
            Query query;
            query.tolerance.value = 1e-9;
            query.budget = budget;
            Trace trace;
            const Result result = session.solve(query, trace);
            if (budget <= 5) {
                EXPECT_EQ(to_string(result.status), to_string(Status::budget)) << budget;
            }
            if (result.status == Status::converged) {
                EXPECT_EQ(result.bounds.upper, whole.bounds.upper) << budget;
            }
            EXPECT_LE(result.bounds.lower, whole.bounds.lower) << budget;
            EXPECT_GE(result.bounds.upper, whole.bounds.upper) << budget;
            EXPECT_LE(result.bounds.upper, 2 * diagonal(pair.b)) << budget;
        }
    }
}

// Far from B, first guesses of closest points are poor, so the farthest point is often among those that the budget
// leaves undecided.
TEST(Scan, PointsThatItLeavesUndecidedMayBeTheFarthest) {
    const SolverEntry& entry = find_solver("scan");
    int stopped_short = 0;
    for (int scene = 0; scene < 20; ++scene) {
        Random random(400 + static_cast<std::uint64_t>(scene));
        const Pair pair{"", stacked(cloud(random, 4000, 0.9), sphere(random, 500) * 1.9), cloud(random, 3000)};
        const Result whole = answer("naive", pair, Pose{});
        const Session session(entry, Options("scan", entry.info.parameters, {}),
                              Scene{PointSet{pair.a}, PointSet{pair.b}}, {});
        for (const std::uint64_t budget : {1, 9, 20}) {
            Query query;
            query.tolerance.value = 1e-9;
            query.budget = budget;
            Trace trace;
            const Result result = session.solve(query, trace);
            EXPECT_LE(result.bounds.lower, whole.bounds.lower) << scene << ", " << budget;
            EXPECT_GE(result.bounds.upper, whole.bounds.upper) << scene << ", " << budget;
            stopped_short += result.status == Status::budget && result.bounds.lower < whole.bounds.lower;
        }
    }
    EXPECT_GE(stopped_short, 10);
}

// A and B are large enough for many blocks of work.
TEST(Scan, SameWorkAndWitnessWhateverTheThreads) {
    Random random(43);
    for (int i = 0; i < 2 * kinds; ++i) {
        const Pair pair = random_pair(random, i % kinds, 20'000 + random.below(20'000), 40'000 + random.below(20'000));
        const std::string where = "scene " + std::to_string(i) + ", " + pair.name;
        Result single;
        for (const int threads : {1, 2, 3, 8}) {
            const Result result = with_threads(pair, threads, {{"threads_from", std::int64_t{0}}});
            if (threads == 1) single = result;
            EXPECT_EQ(result.bounds.lower, single.bounds.lower) << where;
            EXPECT_EQ(result.bounds.upper, single.bounds.upper) << where;
            EXPECT_EQ(result.witness.source_element, single.witness.source_element) << where;
            EXPECT_EQ(result.witness.target_element, single.witness.target_element) << where;
            EXPECT_EQ(result.counters, single.counters) << where;
        }
    }
}

// Each chosen row must be in its cell's list once, for any number of threads.
TEST(PointCells, HoldEachChosenRowOnce) {
    Random random(44);
    for (int i = 0; i < 3 * kinds; ++i) {
        const Points points = random_pair(random, i % kinds, 1, 1 + random.below(i < kinds ? 20 : 3000)).b;
        if (magnitude(points) > 1e100) continue;
        std::vector<Index> chosen;
        for (Index j = 0; j < points.rows(); ++j)
            if (random.below(3) > 0) chosen.push_back(j);
        const std::vector<Index>* const which = i % 2 == 0 ? &chosen : nullptr;
        if (which && chosen.empty()) continue;
        const Box box = extent_of(points).box;
        const double per_length = std::pow(10.0, random.below(5)) / std::max((box.high - box.low).maxCoeff(), 1e-300);
        const PointCells single(points, which, box, per_length, Threads(1)),
            three(points, which, box, per_length, Threads(3));
        for (Index j = 0; j < points.rows(); ++j) {
            const PointCells::Cell cell = single.cell_of(points.row(j).data());
            int times = 0;
            Index other = three.first(cell);
            for (Index k = single.first(cell); k >= 0; k = single.next(k), other = three.next(other)) {
                ASSERT_EQ(k, other);
                times += k == j;
                ASSERT_TRUE(!which || std::binary_search(chosen.begin(), chosen.end(), k));
            }
            ASSERT_LT(other, 0);
            ASSERT_EQ(times, !which || std::binary_search(chosen.begin(), chosen.end(), j) ? 1 : 0);
        }
    }
}

// Point P of B is at the first double of a cell. The grid knows only Q, whose squared distance is one ulp larger. The
// rounded root of it falls short of P, so a search range without slack misses P.
TEST(PointCells, ASearchFindsWhatIsCloserByTheLastBit) {
    Random random(45);
    int needed = 0;
    // The cells are a row along x, which fits into the table: no two of them share an entry. The other points make the
    // table large enough, and are farther from P than Q is.
    Points others = cloud(random, 20, 0.005);
    others.col(0).array() += 1.9;
    for (int i = 0; i < 20000 && needed < 50; ++i) {
        const Box box{Vec3(-2, -0.01, -0.01), Vec3(2, 0.01, 0.01)};
        const double per_length = 4 + random.unit();
        Points ends(2, 3);
        ends.row(0) = box.low;
        ends.row(1) = box.high;
        const PointCells grid(ends, nullptr, box, per_length, Threads(1));
        double before = 0.5, edge = 0.9;
        const auto cell = [&](double x) { return grid.cell_of(Vec3(x, 0, 0).data())[0]; };
        while (std::nextafter(before, 1) < edge) {
            const double middle = before + (edge - before) / 2;
            (cell(middle) == cell(0.5) ? before : edge) = middle;
        }
        const double x = -0.2 * random.unit(), apart = edge - x;
        const Points a = rows({{x, 0, 0}});
        const double least = squared_distance(a.data(), Vec3(edge, 0, 0).data()), more = std::nextafter(least, 10);
        // Q lies on the other side; a small y makes its squared distance one ulp larger.
        Points b = rows({{x - apart, 0, 0}, {edge, 0, 0}});
        for (double y = 1e-9; y < 4e-8 && squared_distance(a.data(), b.data()) < more; y *= 1.02) b(0, 1) = y;
        if (squared_distance(a.data(), b.data()) != more || b(0, 0) < box.low[0]) continue;
        if (cell(x + std::sqrt(more)) == cell(edge)) continue;
        ++needed;
        const NearGrid near(Points(b.topRows(1)), {Vec3(b.row(0)), Vec3(b.row(0))});
        const Points all = stacked(b, others);
        const PointCells cells(all, nullptr, box, per_length, Threads(1));
        CellFindings findings;
        findings.farthest.squared = 0;
        search_cells(cells, near, a, 0, 1, all, findings);
        ASSERT_TRUE(findings.open.empty());
        ASSERT_EQ(findings.farthest.squared, least) << "x = " << x;
        ASSERT_EQ(findings.farthest.target, 1);
    }
    EXPECT_EQ(needed, 50);
}

// The closest point is last in a list too long to be searched, so the search must leave the query point undecided.
TEST(PointCells, CrowdedCellsLeaveAPointOpen) {
    Random random(46);
    const Points b =
        stacked(rows({{0.001, 0, 0}}), (cloud(random, 5000, 1e-4).rowwise() + Eigen::RowVector3d(0.002, 0, 0)));
    const Points a = rows({{0, 0, 0}});
    const Box box = extent_of(b).box;
    for (const double per_length : {1.0, 1e6}) {
        const PointCells cells(b, nullptr, box, per_length, Threads(1));
        CellFindings findings;
        findings.farthest.squared = 0;
        search_cells(cells, NearGrid(b.bottomRows(1), extent_of(b.bottomRows(1)).box), a, 0, 1, b, findings);
        EXPECT_EQ(findings.open, std::vector<Index>{0});
        EXPECT_EQ(findings.farthest.squared, 0);
    }
}

TEST(PointBlocks, BoxesHoldTheirPointsAndEveryPointIsThereOnce) {
    Random random(35);
    for (int i = 0; i < 4 * kinds; ++i) {
        const Points points = random_pair(random, i % kinds, 1, 1 + random.below(i < kinds ? 20 : 5000)).b;
        if (magnitude(points) > 1e100) continue;  // scenes are scaled before this
        const PointBlocks blocks(points);
        std::multiset<Index> rows;
        ASSERT_TRUE(std::is_sorted(blocks.keys.begin(), blocks.keys.end()));
        ASSERT_EQ(blocks.keys.size(), blocks.leaves.size());
        for (std::size_t l = 0; l < blocks.leaves.size(); ++l) {
            const PointLeaf& leaf = blocks.leaves[l];
            for (std::size_t k = 0; k < block_points; ++k) {
                ASSERT_EQ(Vec3(points.row(leaf.row[k])), Vec3(leaf.x[k], leaf.y[k], leaf.z[k]));
                if (k == 0 || leaf.row[k] != leaf.row[k - 1]) rows.insert(leaf.row[k]);
                std::size_t child = l;  // from the leaf up to the root
                for (std::size_t level = 0; level < blocks.levels(); ++level) {
                    const BlockNode& node = blocks.nodes[blocks.level_begin[level] + child / block_children];
                    for (std::size_t axis = 0; axis < 3; ++axis) {
                        const double x = points(leaf.row[k], static_cast<Index>(axis));
                        ASSERT_LE(node.low[axis][child % block_children], x);
                        ASSERT_GE(node.high[axis][child % block_children], x);
                    }
                    child /= block_children;
                }
                ASSERT_EQ(child, 0U);
            }
        }
        ASSERT_EQ(rows.size(), static_cast<std::size_t>(points.rows()));
        ASSERT_EQ(std::set<Index>(rows.begin(), rows.end()).size(), rows.size());
    }
}

TEST(NearGrid, CandidatesArePointsOfTheSetAndMarksHoldAllNearOnes) {
    Random random(36);
    for (int i = 0; i < 8 * kinds; ++i) {
        const Pair pair = random_pair(random, i % kinds, 20, 1 + random.below(2000));
        if (magnitude(pair.a) > 1e100 || magnitude(pair.b) > 1e100) continue;
        const NearGrid grid(pair.b, extent_of(pair.b).box);
        for (Index p = 0; p < pair.a.rows(); ++p) {
            const double* const point = pair.a.row(p).data();
            const NearGrid::Candidate& candidate = grid.candidate(point);
            ASSERT_EQ(Vec3(pair.b.row(candidate.row)),
                      Vec3(candidate.point[0], candidate.point[1], candidate.point[2]));
            const double squared = squared_distance(point, candidate.point);
            std::vector<std::uint8_t> flags(grid.cells());
            grid.mark(point, distance_at_most(squared, true), flags);
            for (Index j = 0; j < pair.b.rows(); ++j) {
                if (squared_distance(point, pair.b.row(j).data()) > squared) continue;
                ASSERT_TRUE(flags[grid.cell_of(pair.b.row(j).data())]) << pair.name;
            }
        }
    }
}

// Returns the first double of some grid cell along x (with y = z = 0), between 0.3 and 0.7 of the size.
double first_of_a_cell(const NearGrid& grid, double size = 1) {
    double before = 0.3 * size, first = 0.7 * size;
    const auto cell = [&](double x) { return grid.cell_of(Vec3(x, 0, 0).data()); };
    while (std::nextafter(before, 1) < first) {
        const double middle = before + (first - before) / 2;
        (cell(middle) == cell(0.3 * size) ? before : first) = middle;
    }
    return first;
}

// mark() must mark the cells of all points within the radius along each axis. Here a point is at the first double of a
// cell, and the radius is the smallest double that reaches it: a range that ends one double too early misses it.
TEST(NearGrid, MarksEndAtTheVeryPoint) {
    Random random(38);
    const NearGrid grid(stacked(cloud(random, 4000), rows({{-1, -1, -1}, {1, 1, 1}})), {-Vec3::Ones(), Vec3::Ones()});
    const double edge = first_of_a_cell(grid);
    int inexact = 0;
    for (int i = 0; i < 2000; ++i) {
        const double x = -random.unit();
        const exact::Rational apart = exact::Rational(edge) - exact::Rational(x);
        double radius = edge - x;
        if (exact::Rational(radius) < apart) radius = std::nextafter(radius, 2);
        inexact += exact::Rational(radius) != apart;
        std::vector<std::uint8_t> flags(grid.cells());
        const double here[] = {x, 0, 0}, there[] = {edge, 0, 0};
        grid.mark(here, radius, flags);
        ASSERT_TRUE(flags[grid.cell_of(there)]) << x;
        std::vector<std::uint8_t> fewer(grid.cells());
        grid.mark(here, radius - 1e-15, fewer);
        ASSERT_FALSE(fewer[grid.cell_of(there)]) << "the point is not at the very end: nothing was tested";
    }
    EXPECT_GT(inexact, 200);
}

// Point a of A is 1.2 from its candidate b, which is at the first double of a cell. All other points of A are decoys
// with closer points in B, so the answer depends on the cells marked for a. A radius without slack ends before b if the
// difference was rounded down.
TEST(NearGrid, TheRadiusHoldsTheCandidateItself) {
    Random random(39);
    Points b(4000, 3);
    for (Index j = 0; j < 4000; ++j)
        b.row(j) << 0.6 + 0.4 * random.unit(), 0.3 + 1.7 * random.unit(), 0.4 * random.unit() - 0.2;
    b = stacked(b, rows({{0, 2, 0}, {1, 0, 0}, {1, 0.02, 0}, {0, 0, 0}}));
    const auto last = static_cast<Index>(b.rows()) - 1;
    const double edge = first_of_a_cell(NearGrid(b, extent_of(b).box));
    b(last, 0) = edge;
    int rounded_down = 0;
    for (int i = 0; i < 300; ++i) {
        const double x = edge - 1.2 + 0.01 * random.unit(), apart = edge - x;
        rounded_down += exact::Rational(x) + exact::Rational(apart) < exact::Rational(edge);
        Points a(11, 3);
        a.rowwise() = Eigen::RowVector3d(1 + apart - 1e-6, 0, 0);
        a.row(10) << x, 0, 0;
        const Pair pair{"a candidate at the first double of a cell", a, b};
        expect_same(pair, Pose{}, answer("scan", pair, Pose{}), "x = " + std::to_string(x));
        const NearGrid grid(b, extent_of(b).box);
        std::vector<std::uint8_t> flags(grid.cells());
        grid.mark_within(a.row(10).data(), squared_distance(a.row(10).data(), b.row(last).data()), flags);
        ASSERT_TRUE(flags[grid.cell_of(b.row(last).data())]) << x;
    }
    EXPECT_GT(rounded_down, 20);
}

// Squares underflow here, because an outlier of B at 0.75 prevents scaling: 20.4 times the smallest double is rounded
// to 20 times, whose root is 1 % too short.
TEST(NearGrid, TheRadiusHoldsWhereSquaresUnderflow) {
    Random random(40);
    const double unit = 0x1p-537, size = 25 * unit;
    Points b(4000, 3);
    for (Index j = 0; j < 4000; ++j)
        b.row(j) << 0.6 + 0.4 * random.unit(), 0.3 + 1.7 * random.unit(), 0.4 * random.unit() - 0.2;
    b = stacked(b, rows({{0, 2, 0}, {1, 0, 0}, {1, 1.6 / 25, 0}, {0, 0, 0}})) * size;
    b = stacked(rows({{0.75, 0.75, 0.75}}), b);
    const auto last = static_cast<Index>(b.rows()) - 1;
    b(last, 0) = first_of_a_cell(NearGrid(b, extent_of(b).box), size);
    Points a(11, 3);
    a.rowwise() = Eigen::RowVector3d(size + std::sqrt(19.0) * unit, 0, 0);
    a.row(10) << b(last, 0) - std::sqrt(20.4) * unit, 0, 0;
    const double squared = squared_distance(a.row(10).data(), b.row(last).data());
    ASSERT_EQ(squared, 20 * 0x1p-1074);
    ASSERT_LT(distance_at_most(squared, false), b(last, 0) - a(10, 0)) << "the slack is not needed here";
    const NearGrid grid(b, extent_of(b).box);
    std::vector<std::uint8_t> flags(grid.cells());
    grid.mark_within(a.row(10).data(), squared, flags);
    EXPECT_TRUE(flags[grid.cell_of(b.row(last).data())]);
    const Pair pair{"squares underflow", a, b};
    expect_same(pair, Pose{}, answer("scan", pair, Pose{}), "scan");
}

std::uint64_t work_of(const Pair& pair) {
    const Result result = answer("scan", pair, Pose{});
    EXPECT_EQ(result.status, Status::converged) << pair.name;
    std::uint64_t sum = 0;
    for (const CounterField& field : counter_fields) sum += result.counters.*field.member;
    return sum;
}

Index candidates_beyond(double radius, const Points& a, const Points& b) {
    const NearGrid grid(b, extent_of(b).box);
    Index count = 0;
    for (Index i = 0; i < a.rows(); ++i)
        count += squared_distance(a.row(i).data(), grid.candidate(a.row(i).data()).point) > radius * radius;
    return count;
}

// The grid must not take its scale from outliers, wherever they are in B: here, at each row that a sample at equal
// steps would take. Compares with the same points in random order.
TEST(Scan, OutliersAtEqualStepsCostNoMore) {
    Random random(41);
    const Points tame = cloud(random, 40'000);
    Points b = tame;
    for (Index i = 0; i < 1024; ++i) b.row(40'000 * i / 1024) = 1e4 * random.vector();
    const Points scattered = shuffled(random, b), near = noisy(random, tame, 1e-3),
                 a = stacked(near, rows({{1.5, 1.5, 1.5}}));
    EXPECT_LT(candidates_beyond(0.5, near, scattered), 400);
    EXPECT_LT(candidates_beyond(0.5, near, b), 400);
    const std::uint64_t work = work_of({"outliers at equal steps", a, b}),
                        measure = work_of({"outliers in random order", a, scattered});
    EXPECT_LT(static_cast<double>(work), 1.02 * static_cast<double>(measure));
}

// Most points of B coincide, which must not spoil the grid's scale. Each copy may only add a comparison with each of
// the twelve points of A that are compared with all of B.
TEST(Scan, CopiesOfOnePointCostAFewPasses) {
    Random random(42);
    const Points tame = cloud(random, 4'000), outliers = cloud(random, 4, 1e4);
    const Points near = noisy(random, tame, 1e-3), a = stacked(near, rows({{1.5, 1.5, 1.5}}));
    const std::uint64_t without = work_of({"outliers", a, stacked(tame, outliers)});
    for (const Index copies : {Index{40'000}, Index{100'000}}) {
        Points same(copies, 3);
        same.rowwise() = tame.row(7);
        const Points b = shuffled(random, stacked(stacked(tame, outliers), same));
        EXPECT_LT(candidates_beyond(0.5, near, b), 40) << copies;
        EXPECT_LE(work_of({"copies of one point", a, b}), without + 12 * static_cast<std::uint64_t>(copies)) << copies;
    }
}

TEST(Extent, EqualsThePlainPass) {
    Random random(37);
    for (Index count = 1; count < 60; ++count) {
        for (const double least : {0.0, 1e-300}) {
            Points points = cloud(random, count);
            points(random.below(count), random.below(3)) = least;
            const Extent extent = extent_of(points);
            EXPECT_EQ(extent.box.low, Vec3(points.colwise().minCoeff()));
            EXPECT_EQ(extent.box.high, Vec3(points.colwise().maxCoeff()));
            EXPECT_EQ(extent.tiny, least > 0);
        }
    }
}

}  // namespace
}  // namespace hausbench
