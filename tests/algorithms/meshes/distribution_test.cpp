// The statistics of the distance to B: closed forms, random pairs against bounds found in another way, and hostile
// shapes.
#include "algorithms/kernel/point_triangle.h"
#include "algorithms/kernel/quad.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/meshes/distribution/narrow.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using namespace distribution;

using Kind = Statistic::Kind;

TriangleMesh mesh_of(const std::vector<Triangle>& triangles) {
    Points corners(static_cast<Eigen::Index>(3 * triangles.size()), 3);
    for (Eigen::Index i = 0; i < corners.rows(); ++i) {
        const Triangle& t = triangles[static_cast<std::size_t>(i / 3)];
        corners.row(i) = i % 3 == 0 ? t.a : i % 3 == 1 ? t.b : t.c;
    }
    return soup(std::move(corners));
}

// A parallelogram with a corner at `at` and the sides x and y.
std::vector<Triangle> plate(const Vec3& at, const Vec3& x, const Vec3& y) {
    return {{at, at + x, at + x + y}, {at, at + x + y, at + y}};
}

TriangleMesh point(const Vec3& p) { return mesh_of({{p, p, p}}); }

Narrowed answer(const TriangleMesh& a, const TriangleMesh& b, const Query& query, CountedBy weigh = CountedBy::area) {
    const TriangleBlocks blocks(b);
    const OneWay way{a.triangles, a.vertices, blocks, weigh};
    Trace unwatched;
    return narrow(&way, nullptr, std::max(magnitude(a.vertices), magnitude(b.vertices)), query, unwatched);
}

Bounds bounds_of(const TriangleMesh& a, const TriangleMesh& b, const Statistic& statistic, double tolerance = 1e-10) {
    Query query;
    query.statistics = {statistic};
    query.tolerance = {Tolerance::Of::absolute, tolerance};
    query.share_tolerance = tolerance;
    query.budget = 2'000'000;
    return answer(a, b, query).bounds[0];
}

// Expects that the bounds contain a closed form and come within 1e-9 of it.
void expect_closed(const TriangleMesh& a, const TriangleMesh& b, const Statistic& statistic, double value) {
    const Bounds bounds = bounds_of(a, b, statistic);
    const double rounding = 4 * unit_roundoff * value;  // of `value`
    EXPECT_LE(bounds.lower, value + rounding);
    EXPECT_GE(bounds.upper, value - rounding);
    EXPECT_LE(bounds.gap(), 1e-9);
}

// Here bisectors cut off one sliver after another, each as long as the last.
TEST(Distribution, SliversGetShorter) {
    const TriangleMesh a = mesh_of({{{0.75, 0.5, 0.25}, {0.25, 0.25, 0.25}, {0.5, 0.75, 0.5}},
                                    {{0.25, 0.5, 1}, {0.75, 0.25, 1}, {0, 0.75, 1}},
                                    {{0, 1, 0}, {0.25, 1, 0}, {0.75, 0.5, 1}},
                                    {{1, 0, 0.25}, {0.25, 0.75, 0.5}, {0.75, 1, 0.25}}});
    const TriangleMesh b = mesh_of({{{0.5, 0.75, 0}, {0.5, 0, 1}, {0.25, 1, 0.75}},
                                    {{1, 0.5, 1}, {0.75, 0.5, 0.25}, {0, 0.5, 0}},
                                    {{0.25, 0.75, 0.5}, {0, 0, 0}, {0.75, 0.25, 0.75}},
                                    {{1, 1, 0.75}, {1, 0.25, 1}, {0.75, 0, 0}},
                                    {{1, 0.75, 0.75}, {1, 1, 0.5}, {0.75, 0.75, 1}}});
    EXPECT_LE(bounds_of(a, b, {Kind::maximum}, 1e-6).gap(), 1e-6);
}

TEST(Distribution, ParallelPlates) {
    const TriangleMesh a = mesh_of(plate({0.1, 0.2, 0.75}, {0.5, 0, 0}, {0, 0.5, 0}));
    const TriangleMesh b = mesh_of(plate({0, 0, 0.25}, {1, 0, 0}, {0, 1, 0}));
    expect_closed(a, b, {Kind::mean}, 0.5);
    expect_closed(a, b, {Kind::rms}, 0.5);
    expect_closed(a, b, {Kind::maximum}, 0.5);
    expect_closed(a, b, {Kind::quantile, 0.95}, 0.5);
    const Bounds deviation = bounds_of(a, b, {Kind::deviation});
    EXPECT_EQ(deviation.lower, 0);
    EXPECT_LE(deviation.upper, 1e-6);  // the root of the rounding errors
    expect_closed(a, b, {Kind::share_within, 0.5 + 1e-12}, 1);
    expect_closed(a, b, {Kind::share_within, 0.5 - 1e-12}, 0);
}

TEST(Distribution, TiltedPlates) {  // the distance grows from 0.1 to 1.1
    const TriangleMesh a = mesh_of(plate({0, 0, 0.1}, {1, 0, 1}, {0, 1, 0}));
    const TriangleMesh b = mesh_of(plate({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}));
    expect_closed(a, b, {Kind::mean}, 0.6);
    expect_closed(a, b, {Kind::rms}, std::sqrt((1.331 - 0.001) / 3));
    expect_closed(a, b, {Kind::deviation}, std::sqrt(1.0 / 12));
    expect_closed(a, b, {Kind::quantile, 0.5}, 0.6);
    expect_closed(a, b, {Kind::quantile, 0.95}, 1.05);
    expect_closed(a, b, {Kind::share_within, 0.35}, 0.25);
    expect_closed(a, b, {Kind::maximum}, 1.1);
}

TEST(Distribution, CrossingPlates) {  // the distance is |x - 1/2|
    const TriangleMesh a = mesh_of(plate({0, 0, -0.5}, {1, 0, 1}, {0, 1, 0}));
    const TriangleMesh b = mesh_of(plate({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}));
    expect_closed(a, b, {Kind::mean}, 0.25);
    expect_closed(a, b, {Kind::rms}, std::sqrt(1.0 / 12));
    expect_closed(a, b, {Kind::deviation}, std::sqrt(1.0 / 12 - 1.0 / 16));
    expect_closed(a, b, {Kind::quantile, 0.95}, 0.475);
    expect_closed(a, b, {Kind::share_within, 0.1}, 0.2);
}

TEST(Distribution, APlateAboveAValley) {  // B is z = |x|, so the distance is (1 - |x|) / sqrt(2)
    const TriangleMesh a = mesh_of(plate({-0.25, 0, 1}, {0.75, 0, 0}, {0, 1, 0}));
    std::vector<Triangle> walls = plate({0, -4, 0}, {0, 8, 0}, {4, 0, 4});
    for (const Triangle& t : plate({0, -4, 0}, {0, 8, 0}, {-4, 0, 4})) walls.push_back(t);
    const TriangleMesh b = mesh_of(walls);
    const double root = std::sqrt(2.0), mean = (0.03125 + 0.125) / 0.75;
    expect_closed(a, b, {Kind::mean}, (1 - mean) / root);
    expect_closed(a, b, {Kind::maximum}, 1 / root);
    expect_closed(a, b, {Kind::share_within, 0.75 / root}, 1.0 / 3);
}

TEST(Distribution, APlateAndAPoint) {
    const TriangleMesh a = mesh_of(plate({0, 0, 0}, {1, 0, 0}, {0, 1, 0})), b = point({0, 0, 0});
    expect_closed(a, b, {Kind::mean}, (std::sqrt(2.0) + std::log(1 + std::sqrt(2.0))) / 3);
    expect_closed(a, b, {Kind::rms}, std::sqrt(2.0 / 3));
    expect_closed(a, b, {Kind::share_within, 0.5}, std::acos(-1.0) / 16);
    expect_closed(a, b, {Kind::quantile, std::acos(-1.0) / 16}, 0.5);
    expect_closed(a, b, {Kind::maximum}, std::sqrt(2.0));
}

TEST(Distribution, ACubeAndItsCentre) {
    const TriangleMesh a = cube(1), b = point({0, 0, 0});
    const double root = std::sqrt(3.0);
    expect_closed(a, b, {Kind::mean},
                  root / 3 + 4.0 / 3 * std::log((1 + root) / std::sqrt(2.0)) - std::acos(-1.0) / 18);
    expect_closed(a, b, {Kind::rms}, std::sqrt(5.0 / 3));
    expect_closed(a, b, {Kind::maximum}, root);
}

TEST(Distribution, ConcentricCubes) {
    const TriangleMesh inner = cube(0.5), outer = cube(1);
    for (const Statistic& statistic :
         std::vector<Statistic>{{Kind::mean}, {Kind::rms}, {Kind::maximum}, {Kind::quantile, 0.5}})
        expect_closed(inner, outer, statistic, 0.5);
    // From the outside, the distance is 1/2 above a face, and grows from 1/2 beyond its edges.
    expect_closed(outer, inner, {Kind::maximum}, std::sqrt(0.75));
    expect_closed(outer, inner, {Kind::quantile, 0.2}, 0.5);
}

// Bounds on the statistics from small equal parts of each triangle of A. In a part, the distance to B is within r of the
// distance of its centre, where r is the distance of the farthest corner from the centre. Shares no code with the solver
// but the closest point of one triangle.
struct Exhaustive {
    struct Part {
        double low, high, weight;
    };
    std::vector<Part> parts;

    Exhaustive(const TriangleMesh& a, const TriangleMesh& b, int steps) {
        for (Index i = 0; i < a.triangles.rows(); ++i) {
            const Triangle t = triangle_of(a, i);
            const double scale = magnitude(a.vertices);
            const double area = ((t.b - t.a) / scale).cross((t.c - t.a) / scale).norm();
            for (int x = 0; x < steps; ++x) {
                for (int y = 0; x + y < steps; ++y) {
                    add(t, b, x, y, 1, steps, area);
                    if (x + y < steps - 1) add(t, b, x + 1, y + 1, -1, steps, area);
                }
            }
        }
    }

    void add(const Triangle& t, const TriangleMesh& b, int x, int y, int way, int steps, double area) {
        const auto at = [&](int p, int q) {
            return Vec3(t.a + (t.b - t.a) * (double(p) / steps) + (t.c - t.a) * (double(q) / steps));
        };
        const Vec3 corners[3] = {at(x, y), at(x + way, y), at(x, y + way)};
        const Vec3 centre = (corners[0] + corners[1] + corners[2]) / 3;
        double squared = infinity, radius = 0;
        for (Index i = 0; i < b.triangles.rows(); ++i)
            squared = std::min(squared, closest_point(centre, triangle_of(b, i)).squared_distance);
        for (const Vec3& corner : corners) radius = std::max(radius, (corner - centre).norm());
        const double d = std::sqrt(squared), wide = radius * (1 + 1e-9) + 1e-300;
        parts.push_back({std::max(d - wide, 0.0), d + wide, area / (double(steps) * steps)});
    }

    Bounds of(const Statistic& s) {
        double all = 0, low = 0, high = 0;
        std::vector<std::pair<double, double>> lows, highs;
        for (const Part& part : parts) {
            const double w = part.weight;
            all += w;
            lows.push_back({part.low, w});
            highs.push_back({part.high, w});
            switch (s.kind) {
                case Kind::mean:
                    low += w * part.low, high += w * part.high;
                    break;
                case Kind::rms:
                    low += w * part.low * part.low, high += w * part.high * part.high;
                    break;
                case Kind::share_within:
                    low += w * (part.high <= s.argument), high += w * (part.low <= s.argument);
                    break;
                default:
                    break;
            }
        }
        std::sort(lows.begin(), lows.end());
        std::sort(highs.begin(), highs.end());
        const auto quantile = [&](const auto& sorted, double level) {
            double sum = 0;
            for (const auto& [d, w] : sorted)
                if ((sum += w) >= level * all) return d;
            return sorted.back().first;
        };
        switch (s.kind) {
            case Kind::rms:
                return {std::sqrt(low / all), std::sqrt(high / all)};
            case Kind::quantile:
                return {quantile(lows, s.argument - 1e-9), quantile(highs, s.argument + 1e-9)};
            case Kind::maximum: {
                double least = 0;
                for (const Part& part : parts) least = std::max(least, part.low);
                return {least, highs.back().first};
            }
            default:
                return {low / all, high / all};
        }
    }
};

// Random triangles: some needles, some equal, some degenerate, some far apart, with coordinates on a coarse grid.
TriangleMesh random_soup(Random& random, int most, double scale) {
    std::vector<Triangle> all;
    const auto coordinate = [&] { return random.below(9) / 8 - 0.5; };
    const auto corner = [&] { return Vec3(Vec3(coordinate(), coordinate(), coordinate()) * scale); };
    const int count = 1 + random.below(most);
    for (int i = 0; i < count; ++i) {
        Triangle t{corner(), corner(), corner()};
        const Index kind = random.below(8);
        if (kind == 0) t.c = t.a + (t.b - t.a) * 0.375 + Vec3(0, 0, scale * 1e-9);
        if (kind == 1 && !all.empty()) t = all.back();
        if (kind == 2) t.c = t.b;
        all.push_back(t);
    }
    all.push_back({Vec3(0, 0, 0), Vec3(scale, 0, 0), Vec3(0, scale, 0)});  // so that there is an area
    return mesh_of(all);
}

TEST(Distribution, RandomSoupsAgainstSmallParts) {
    Random random(44);
    for (int pair = 0; pair < 150; ++pair) {
        const double scale = std::ldexp(1.0, random.below(600) - 300);
        const TriangleMesh a = random_soup(random, 4, scale), b = random_soup(random, 6, scale);
        Exhaustive reference(a, b, 12);
        Query query;
        query.statistics = {{Kind::mean},          {Kind::rms},           {Kind::maximum},
                            {Kind::quantile, 0.5}, {Kind::quantile, 0.9}, {Kind::share_within, 0.25 * scale}};
        query.tolerance = {Tolerance::Of::absolute, 1e-3 * scale};
        query.budget = 100'000;
        const Narrowed result = answer(a, b, query);
        for (std::size_t i = 0; i < query.statistics.size(); ++i) {
            const Bounds expected = reference.of(query.statistics[i]);
            EXPECT_LE(result.bounds[i].lower, expected.upper) << "pair " << pair << ", statistic " << i;
            EXPECT_GE(result.bounds[i].upper, expected.lower) << "pair " << pair << ", statistic " << i;
            EXPECT_LE(result.bounds[i].lower, result.bounds[i].upper);
        }
        EXPECT_LE(result.bounds[0].gap(), 1e-3 * scale);
        EXPECT_LE(result.bounds[1].gap(), 1e-3 * scale);
    }
}

// Two triangles a hair above B: the distance is 0.5 and varies by 1e-9, and so little must not be lost in its square.
TEST(Distribution, ASmallDeviationOfALargeDistance) {
    const TriangleMesh a = mesh_of(plate({0, 0, 0.5}, {0.5, 0, 1e-9}, {0, 0.5, 0}));
    const Bounds bounds = bounds_of(a, mesh_of(plate({-1, -1, 0}, {2, 0, 0}, {0, 2, 0})), {Kind::deviation}, 1e-13);
    const double height = (0.5 + 1e-9) - 0.5;
    EXPECT_LE(bounds.lower, height / std::sqrt(12.0));
    EXPECT_GE(bounds.upper, height / std::sqrt(12.0));
    EXPECT_LE(bounds.gap(), 1e-12);
}

// Most triangles of B are equally far from A, too many to gather, so cones bound the distance from below.
TEST(Distribution, TheMiddleOfABall) {
    std::vector<Triangle> all;
    Random random(3);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 p = random.vector().normalized();
        all.push_back({p, p, p});
    }
    const TriangleMesh a = mesh_of(plate({-1e-3, -1e-3, 0}, {2e-3, 0, 0}, {0, 2e-3, 0}));
    Query query;
    query.statistics = {{Kind::mean}};
    query.tolerance = {Tolerance::Of::absolute, 1e-4};
    const Narrowed result = answer(a, mesh_of(all), query);
    EXPECT_LE(result.bounds[0].gap(), 1e-4);
    EXPECT_GE(result.bounds[0].lower, 0.998);
    EXPECT_LE(result.bounds[0].upper, 1);
}

TEST(Distribution, AFlatPartIsNotSearchedForEver) {
    // Half of A is at the distance 1, the other half at 2: the median may be anything in between, and the bounds say so.
    std::vector<Triangle> all = plate({0, 0, 1}, {1, 0, 0}, {0, 1, 0});
    for (const Triangle& t : plate({0, 0, 2}, {1, 0, 0}, {0, 1, 0})) all.push_back(t);
    Query query;
    query.statistics = {{Kind::quantile, 0.5}, {Kind::mean}};
    query.tolerance = {Tolerance::Of::absolute, 1e-3};
    const Narrowed result = answer(mesh_of(all), mesh_of(plate({-2, -2, 0}, {5, 0, 0}, {0, 5, 0})), query);
    EXPECT_EQ(result.status, Status::stalled);
    EXPECT_NE(result.note, "");
    EXPECT_LE(result.bounds[0].lower, 1);
    EXPECT_GE(result.bounds[0].upper, 2);
    EXPECT_NEAR(result.bounds[1].lower, 1.5, 1e-9);
    EXPECT_NEAR(result.bounds[1].upper, 1.5, 1e-9);
    EXPECT_LE(result.pieces, 10'000U);
}

TEST(Distribution, ABudgetEndsTheSearch) {
    Random random(9);
    const TriangleMesh a = random_soup(random, 40, 1), b = random_soup(random, 40, 1);
    Query query;
    query.statistics = {{Kind::mean}};
    query.tolerance = {Tolerance::Of::lower, 1e-12};
    query.budget = 1000;
    const Narrowed result = answer(a, b, query);
    EXPECT_EQ(result.status, Status::budget);
    EXPECT_LE(result.pieces, 10'000U);
}

// All triangles of the fan are near every piece, so each test of a piece takes long.
TEST(Distribution, ASlowSearchStopsSoon) {
    std::vector<Triangle> fan;
    const auto at = [](int i) { return Vec3(0.5 + 0.01 * std::cos(0.0314 * i), 0.5 + 0.01 * std::sin(0.0314 * i), 0); };
    for (int i = 0; i < 200; ++i) fan.push_back({{0.5, 0.5, 0}, at(i), at(i + 1)});
    const TriangleMesh a = sheet(6, 1), b = mesh_of(fan);
    const TriangleBlocks blocks(b);
    Dissection pieces(a.triangles, a.vertices, blocks, 1, CountedBy::area, 1);
    CutWhere where;
    where.mean = 0;
    int looks = 0;
    pieces.refine(
        where, [&](std::size_t) { return ++looks >= 4; }, 1'000'000);
    // Between two looks are at most 8192 / 16 tests. After the last look, each triangle is tested once.
    EXPECT_LE(pieces.counters().bound_tests, 4 * 512 + static_cast<std::uint64_t>(a.triangles.rows()));
    EXPECT_EQ(looks, 4);
}

// Thousands of triangles of B, in a circle around A, are equally near. One piece then takes a search of all of B, so the
// search looks whether to stop after each.
TEST(Distribution, ASearchOfTiesStopsSoon) {
    constexpr int ties = 4000;
    const double angle = 2 * std::acos(-1) / ties;
    std::vector<Triangle> circle;
    const auto at = [&](int i, double z) { return Vec3(std::cos(angle * i), std::sin(angle * i), z); };
    for (int i = 0; i < ties; ++i) circle.push_back({at(i, 0), at(i + 1, 0), at(i, 1e-4)});
    const TriangleMesh a = sheet(6, 1e-6), b = mesh_of(circle);
    const TriangleBlocks of_b(b);
    CutWhere where;
    where.mean = 0;
    const auto searched = [&](Index triangles, int most_looks) {
        const Triangles some = a.triangles.topRows(triangles);
        Dissection pieces(some, a.vertices, of_b, 1, CountedBy::area, 1);
        int looks = 0;
        pieces.refine(
            where, [&](std::size_t) { return ++looks >= most_looks; }, 1'000'000);
        return pieces.counters().node_visits + pieces.counters().point_triangle_distances;
    };
    // The first look is before any search, and after the second look no piece is searched.
    for (const Index triangles : {Index(1), static_cast<Index>(a.triangles.rows())}) {
        EXPECT_GT(searched(triangles, 2), static_cast<std::uint64_t>(ties));
        EXPECT_LT(searched(triangles, 2), static_cast<std::uint64_t>(2 * ties));
    }
}

TEST(Distribution, AStopLeavesTheBoundsOfEarlierRounds) {
    Random random(8);
    const TriangleMesh a = random_soup(random, 30, 1), b = random_soup(random, 30, 1);
    const TriangleBlocks blocks(b);
    Dissection pieces(a.triangles, a.vertices, blocks, 1, CountedBy::area, 1);
    const auto gap = [&] {
        double sum = 0;
        for (const Leaf& leaf : pieces.leaves()) sum += leaf.weight * (leaf.bounds.mean_upper - leaf.bounds.mean_lower);
        return sum;
    };
    CutWhere where;
    where.mean = 1e-4;
    const auto never = [](std::size_t) { return false; };
    pieces.refine(where, never, 1'000'000);
    const double before = gap();
    where.mean = 1e-7;
    int looks = 0;
    pieces.refine(
        where, [&](std::size_t) { return ++looks >= 2; }, 1'000'000);
    EXPECT_LE(gap(), before * (1 + 1e-9));
}

// If triangles of A cross, lower bounds may be far below 0. The upper bounds of these pieces are 0 but for rounding, so cutting
// them would gain nothing.
TEST(Distribution, CrossingTrianglesOfIdenticalMeshesNeedFewPieces) {
    const TriangleMesh a = mesh_of({{{1.63, 0.27, -1.23}, {-0.96, 1.6, 0.2}, {-1.73, -0.08, -1.16}},
                                    {{-0.63, -0.49, -0.71}, {0.55, -0.06, -0.59}, {0.41, 0.83, -1.64}},
                                    {{-0.26, -0.98, -0.17}, {-1.29, 0.02, -0.04}, {-0.3, -1.05, -0.4}}});
    Query query;
    query.statistics = {{Kind::mean}};
    query.tolerance = {Tolerance::Of::lower, 1e-3};
    query.time_limit = 5;
    const Narrowed narrowed = answer(a, a, query);
    EXPECT_EQ(to_string(narrowed.status), to_string(Status::precision_floor));
    EXPECT_LE(narrowed.pieces, 100u);
    EXPECT_LE(narrowed.bounds[0].upper, 1e-12);
}

// One side of A lies in a large triangle of B, and above that side another triangle of B is nearer. All corners are at their
// distance from the large one, and the plane of the other is far below 0 at a corner, where the distance is 0.
TEST(Distribution, LowerBoundsBelowZeroAreGapsIfThePieceRises) {
    const TriangleMesh a = mesh_of({{{0, 0, 0}, {1, 0, 0}, {0.05, 0.5, 0.2}}});
    const TriangleMesh b = mesh_of({{{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}}, {{0, -0.2, 0}, {0, 0.2, 0}, {0, 0, 0.1}}});
    Query query;
    query.statistics = {{Kind::mean}};
    query.tolerance = {Tolerance::Of::lower, 1e-6};
    const Narrowed narrowed = answer(a, b, query);
    EXPECT_EQ(to_string(narrowed.status), to_string(Status::converged));
    EXPECT_LE(narrowed.pieces, 20'000u);
}

TEST(Distribution, TheNumberOfThreadsDoesNotMatter) {
    Random random(7);
    const TriangleMesh a = random_soup(random, 40, 1), b = random_soup(random, 40, 1);
    Query query;
    query.statistics = {{Kind::mean}, {Kind::deviation}, {Kind::quantile, 0.5}};
    query.tolerance = {Tolerance::Of::lower, 1e-4};
    const Narrowed single = answer(a, b, query);
    query.threads = 3;
    const Narrowed several = answer(a, b, query);
    EXPECT_EQ(single.pieces, several.pieces);
    EXPECT_EQ(single.counters, several.counters);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(single.bounds[i].lower, several.bounds[i].lower);
        EXPECT_EQ(single.bounds[i].upper, several.bounds[i].upper);
    }
}

TEST(Distribution, WithoutAreaAllIsBetweenTheLeastAndTheGreatestDistance) {
    const TriangleMesh a = mesh_of({{{0, 0, 1}, {1, 0, 2}, {1, 0, 2}}}),
                       b = mesh_of(plate({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}));
    for (const Statistic& statistic : std::vector<Statistic>{{Kind::mean}, {Kind::rms}, {Kind::quantile, 0.5}}) {
        const Bounds bounds = bounds_of(a, b, statistic);
        EXPECT_LE(bounds.lower, 1);
        EXPECT_GE(bounds.upper, 2);
        EXPECT_LE(bounds.upper, 2.1);
    }
}

TEST(Distribution, PointsCountOnceEach) {
    TriangleMesh a;
    a.vertices.resize(4, 3);
    a.vertices << 0, 0, 1, 0, 0, 2, 0, 0, 2, 0, 0, 7;
    a.triangles.resize(4, 3);
    for (Index i = 0; i < 4; ++i) a.triangles.row(i) << i, i, i;
    Query query;
    query.statistics = {
        {Kind::mean}, {Kind::quantile, 0.5}, {Kind::share_within, 2 + 1e-12}, {Kind::maximum}, {Kind::rms}};
    query.tolerance = {Tolerance::Of::absolute, 1e-12};
    query.share_tolerance = 1e-9;
    const Narrowed result = answer(a, point({0, 0, 0}), query, CountedBy::points);
    const double expected[] = {3, 2, 0.75, 7, std::sqrt(58 / 4.0)};
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_LE(result.bounds[i].lower, expected[i] * (1 + 1e-15));
        EXPECT_GE(result.bounds[i].upper, expected[i] * (1 - 1e-15));
        EXPECT_LE(result.bounds[i].gap(), 1e-10);
    }
}

// However coarse the tolerance is: the limits of the first rounds may be above all gaps.
TEST(Distribution, EveryToleranceIsReached) {
    const TriangleMesh a = mesh_of({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}), b = point({0.3, 0.3, 0.5});
    for (const Statistic& statistic : std::vector<Statistic>{{Kind::mean},
                                                             {Kind::rms},
                                                             {Kind::deviation},
                                                             {Kind::maximum},
                                                             {Kind::quantile, 0.5},
                                                             {Kind::share_within, 0.6}}) {
        for (const double tolerance : {0.3, 0.1, 0.05, 0.02, 5e-3, 1e-3, 1e-4}) {
            Query query;
            query.statistics = {statistic};
            query.tolerance = {Tolerance::Of::absolute, tolerance};
            query.share_tolerance = tolerance;
            const Narrowed result = answer(a, b, query);
            EXPECT_EQ(result.status, Status::converged) << to_string(statistic) << " to " << tolerance;
            EXPECT_LE(result.bounds[0].gap(), tolerance);
            EXPECT_LE(result.pieces, 100'000U) << to_string(statistic) << " to " << tolerance;
        }
    }
}

// One of many points, or of many equal triangles, is farther: the share of the others is not a double, and its upper
// bound must not be below it.
TEST(Distribution, AShareThatIsNotADouble) {
    for (const Index count : {3000, 50'000, 70'001}) {
        for (const CountedBy weigh : {CountedBy::points, CountedBy::area}) {
            const bool number = weigh == CountedBy::points;
            TriangleMesh a =
                mesh_of({{{0, 0, 1}, {0.0625, 0, 1}, {0, 0.0625, 1}}, {{0, 0, 9}, {0.0625, 0, 9}, {0, 0.0625, 9}}});
            a.triangles.resize(count, 3);
            for (Index i = 0; i < count; ++i) a.triangles.row(i) << 0, number ? 0 : 1, number ? 0 : 2;
            a.triangles.row(0) << 3, number ? 3 : 4, number ? 3 : 5;
            Query query;
            query.statistics = {{Kind::share_within, 2}};
            if (number) query.statistics.push_back({Kind::quantile, double(count - 1) / count});
            query.tolerance = {Tolerance::Of::absolute, 1e-9};
            const Narrowed result = answer(a, point({0, 0, 0}), query, weigh);
            const Quad share = Quad(count - 1) / count;
            EXPECT_LE(Quad(result.bounds[0].lower), share);
            EXPECT_GE(Quad(result.bounds[0].upper), share) << count;
            if (number) {
                EXPECT_LE(result.bounds[1].lower, 1);
                EXPECT_GE(result.bounds[1].upper, 1);
                EXPECT_LE(result.bounds[1].upper, 1 + 1e-15);
            }
        }
    }
}

TEST(Distribution, CombinedValuesHoldUnderRounding) {
    using Over = Statistic::Over;
    Random random(12);
    const double least = std::numeric_limits<double>::denorm_min();
    std::vector<std::pair<double, double>> pairs = {{least, 0}, {0, 0}, {least, 3 * least}, {1e-310, 1}};
    for (int i = 0; i < 10'000; ++i) pairs.emplace_back(random.real(0, 1), random.real(0, 1) * random.real(0, 1));
    for (const auto& [x, y] : pairs) {
        const Quad a = x, b = y;
        const Quad mean = (a + b) / 2, harmonic = x > 0 && y > 0 ? 2 * a * b / (a + b) : Quad(0);
        for (const auto& [over, exact] : {std::pair(Over::mean_of_both, mean), {Over::harmonic_mean, harmonic}}) {
            const Bounds bounds = combined(over, {x, x}, {y, y});
            EXPECT_LE(Quad(bounds.lower), exact) << x << ", " << y;
            EXPECT_GE(Quad(bounds.upper), exact) << x << ", " << y;
            EXPECT_LE(bounds.gap(), 1e-14 * double(exact) + 4 * least);
        }
    }
}

TEST(Distribution, ATimeLimitLeavesValidBounds) {
    Random random(9);
    const TriangleMesh a = random_soup(random, 40, 1), b = random_soup(random, 40, 1);
    Query query;
    query.statistics = {{Kind::mean}, {Kind::quantile, 0.5}};
    query.tolerance = {Tolerance::Of::lower, 1e-4};
    const Narrowed full = answer(a, b, query);
    query.time_limit = 0;
    const Narrowed none = answer(a, b, query);
    EXPECT_EQ(none.status, Status::time_limit);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_LE(none.bounds[i].lower, full.bounds[i].lower);
        EXPECT_GE(none.bounds[i].upper, full.bounds[i].upper);
    }
}

}  // namespace
}  // namespace hausbench
