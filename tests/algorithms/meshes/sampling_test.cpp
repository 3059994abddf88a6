// The covering radius of grids on triangles, and the intervals, samples and stops of the solver `sampling`.
#include "algorithms/kernel/closest.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/exact_points.h"
#include "tests/support/reference.h"
#include "tests/support/scenes.h"
#include "tests/support/triangle_samples.h"

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using exact::Rational;
using exact::RVec3;
using exact::operator-;

// --- the lemmas of kernel/rounding.h ----------------------------------------------------------------------------------

Rational squared_longest_edge(const Triangle& t) {
    const RVec3 a = exact::vector(t.a), b = exact::vector(t.b), c = exact::vector(t.c);
    return std::max({exact::squared_distance(a, b), exact::squared_distance(b, c), exact::squared_distance(c, a)});
}

double squared_edge_as_computed(const Triangle& t) {
    return std::max({squared_length(t.b - t.a), squared_length(t.c - t.b), squared_length(t.a - t.c)});
}

RVec3 combination(const Triangle& t, const Rational& i, const Rational& j, const Rational& k) {
    const RVec3 a = exact::vector(t.a), b = exact::vector(t.b), c = exact::vector(t.c);
    RVec3 sum;
    for (std::size_t d = 0; d < 3; ++d) sum[d] = i * a[d] + j * b[d] + k * c[d];
    return sum;
}

// Every point of a triangle must be within the covering radius of a grid point. Exact, with thin and degenerate
// triangles.
TEST(Grid, CoversTheTriangle) {
    Random random(1);
    for (const Kind& kind : kinds()) {
        for (int trial = 0; trial < 12; ++trial) {
            const Triangle t = kind.make(random).triangle;
            const int n = 1 + trial % 4;
            double s = random.unit(), r = random.unit();
            if (s + r > 1) s = 1 - s, r = 1 - r;
            const RVec3 p = combination(t, 1 - Rational(s) - Rational(r), s, r);
            Rational least = exact::squared_distance(p, exact::vector(t.a));
            for (int i = 0; i <= n; ++i) {
                for (int j = 0; j <= n - i; ++j) {
                    const RVec3 q = combination(t, Rational(i) / n, Rational(j) / n, Rational(n - i - j) / n);
                    least = std::min(least, exact::squared_distance(p, q));
                }
            }
            EXPECT_TRUE(3 * n * n * least <= squared_longest_edge(t)) << kind.name << ", " << n << " steps";
        }
    }
}

// The centre of a regular triangle attains the radius, so no smaller factor is valid.
TEST(Grid, TheCentreOfARegularTriangleIsAsFarAsAllowed) {
    const Triangle t{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const Rational third = Rational(1) / 3;
    const Rational squared = exact::squared_distance(combination(t, third, third, third), exact::vector(t.a));
    EXPECT_TRUE(3 * squared == squared_longest_edge(t));
    for (const std::int64_t n : {1, 2, 7, 1000}) {
        const Rational at_samples = 1e-9,
                       radius = grid_distance_at_most(1e-9, squared_edge_as_computed(t), n) - at_samples;
        EXPECT_TRUE(n * n * radius * radius >= squared) << n;
        EXPECT_TRUE(n * n * radius * radius <= squared * Rational(1.0000001)) << n;
    }
}

// The radius includes the rounding of the edge, of the quotient and of the sum; each is the largest in some samples.
TEST(Grid, BoundsHoldAgainstExactArithmetic) {
    Random random(2);
    for (int trial = 0; trial < 30000; ++trial) {
        const Vec3 a = random.vector(), b = a + std::pow(10, random.real(-3, 0)) * random.vector();
        const Triangle t{a, b, a};
        const std::int64_t n = 1 + random.below(1000);
        const double at_samples = trial % 2 == 0 ? 1e-25 : random.real(0.5, 8);
        const Rational radius =
            Rational(grid_distance_at_most(at_samples, squared_edge_as_computed(t), n)) - Rational(at_samples);
        ASSERT_TRUE(radius >= 0 && 3 * n * n * radius * radius >= squared_longest_edge(t)) << trial;
    }
    EXPECT_EQ(grid_distance_at_most(0, 0, 1), 0) << "all is one point at the origin";
}

// The edge is so short that its square is 0 in doubles.
TEST(Grid, BoundsHoldWhereAnEdgeUnderflows) {
    const double edge = 0x1p-540, at_samples = 8 * unit_roundoff * smallest_safe_magnitude;
    EXPECT_EQ(edge * edge, 0);
    const Rational radius = Rational(grid_distance_at_most(at_samples, edge * edge, 1)) - Rational(at_samples);
    EXPECT_TRUE(3 * radius * radius >= Rational(edge) * Rational(edge));
}

TEST(Grid, PointsAreAsCloseToTheirTriangleAsDerived) {
    Random random(3);
    Rational worst = 0;
    for (int trial = 0; trial < 30000; ++trial) {
        const auto corner = [&] { return Vec3(random.real(0.5, 1), random.real(0.5, 1), random.real(0.5, 1)); };
        const Triangle t{corner(), corner(), corner()};
        const std::int64_t n = 1 + random.below(1 << 20), i = random.below(static_cast<Index>(n + 1)),
                           j = random.below(static_cast<Index>(n - i + 1));
        const RVec3 q = exact::vector(grid_point(t.a, t.b, t.c, i, j, n)),
                    p = combination(t, Rational(i) / n, Rational(j) / n, Rational(n - i - j) / n);
        worst = std::max(worst, exact::squared_distance(p, q));
    }
    const Rational u = unit_roundoff;
    EXPECT_TRUE(worst <= 49 * u * u);
    EXPECT_TRUE(worst >= u * u) << "no test of a bound";
    EXPECT_GE(2 * level_of_grid_point, 7);
}

// --- the solver -------------------------------------------------------------------------------------------------------

struct Request {
    double step = 0.1, tolerance = 1e-30;
    double floor = 0, cutoff = std::numeric_limits<double>::infinity();
    double time_limit = std::numeric_limits<double>::infinity();
    std::uint64_t budget = std::numeric_limits<std::uint64_t>::max();
    bool fields = false;
};

Result solve(const Scene& scene, const Request& request, Trace& trace) {
    const SolverEntry& sampling = find_solver("sampling");
    const Session session(sampling, Options("sampling", sampling.info.parameters, {{"step", request.step}}), scene, {});
    Query query;
    query.tolerance = {Tolerance::Of::absolute, request.tolerance};
    query.floor = request.floor;
    query.cutoff = request.cutoff;
    query.time_limit = request.time_limit;
    query.budget = request.budget;
    query.wanted.fields = request.fields;
    return session.solve(query, trace);
}

Result solve(const Scene& scene, const Request& request) {
    Trace trace;
    return solve(scene, request, trace);
}

Scene one_triangle(const Triangle& a, const std::vector<Vec3>& b) {
    return {soup(rows({a.a, a.b, a.c})), points_as_triangles(b)};
}

double longest_edge_of(const Triangle& t) { return std::sqrt(squared_edge_as_computed(t)); }

// Returns the step for which the grid on `t` has n steps per edge; half of it gives 2n.
double step_for(const Triangle& t, std::int64_t n) {
    return longest_edge_of(t) / ((static_cast<double>(n) - 0.01) * diagonal(rows({t.a, t.b, t.c})));
}

void expect_holds(const Result& result, const Rational& squared, const std::string& where) {
    const Rational lower = result.bounds.lower, upper = result.bounds.upper;
    EXPECT_LE(result.bounds.lower, result.bounds.upper) << where;
    EXPECT_TRUE(lower * lower <= squared) << where;
    EXPECT_TRUE(upper * upper >= squared) << where;
}

// The farthest point may be inside A, on an edge or at a corner; the exact distance decides.
TEST(Sampling, IntervalsHoldExactly) {
    Random random(4);
    for (int i = 0; i < 400; ++i) {
        const Triangle a = i % 2 == 0 ? any(random) : thin(random, std::pow(10, random.real(-16, -1)), random.unit());
        std::vector<Vec3> b;
        for (int k = 0; k <= i % 4; ++k) b.push_back(i % 3 == 0 ? inside(a, random) : random.vector());
        const Rational squared = exact_squared(a, b);
        for (const double step : {0.7, 0.2, 0.05}) {
            const Result result = solve(one_triangle(a, b), {.step = step});
            expect_holds(result, squared, std::to_string(i) + ", step " + std::to_string(step));
            const double radius = step * diagonal(rows({a.a, a.b, a.c})) / std::sqrt(3);
            EXPECT_LE(result.bounds.gap(), radius + 1e-14) << i;
        }
    }
}

// B is the grid itself, and the farthest point is the centre of a grid cell, so the full covering radius is needed.
TEST(Sampling, TheWholeRadiusIsNeeded) {
    const Triangle a{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (const int n : {1, 2, 4, 5}) {
        std::vector<Vec3> b;
        for (int i = 0; i <= n; ++i) {
            for (int j = 0; j <= n - i; ++j) b.push_back(grid_point(a.a, a.b, a.c, i, j, n));
        }
        const Scene scene = one_triangle(a, b);
        const Result result = solve(scene, {.step = step_for(a, n)});
        const double h = std::sqrt(2.0 / 3) / n;
        EXPECT_GE(result.bounds.upper, h) << n;
        EXPECT_LE(result.bounds.upper, h + 1e-14) << n;
        EXPECT_LE(result.bounds.lower, 1e-14) << n;
        // The finer grid has points far from B. Its upper bound may be larger than the coarser grid's: 0.79 against
        // 0.58.
        const Result finer = solve(scene, {.step = step_for(a, 2 * n)});
        EXPECT_GT(finer.bounds.lower, 0.86 * h) << n;
        EXPECT_GE(finer.bounds.upper, h) << n;
    }
}

TEST(Sampling, IntervalsOfSoupsContainTheReference) {
    Random random(5);
    for (int i = 0; i < 250; ++i) {
        Points a = cloud(random, 3 * (1 + random.below(5))), b = cloud(random, 3 * (1 + random.below(36)));
        for (Index v = 0; v < a.rows(); ++v) {  // slivers, points, and corners close to B
            if (random.below(3) == 0) a.row(v) = a.row(v - v % 3) + 1e-9 * random.vector().transpose();
            if (random.below(3) == 0) a.row(v) = b.row(random.below(static_cast<Index>(b.rows())));
        }
        const TriangleMesh source = soup(a), target = soup(b);
        const auto [low, high] = MeshReference(target).hausdorff(a, source.triangles, 1e-2L);
        for (const double step : {0.5, 0.1, 0.03}) {
            const Result result = solve({source, target}, {.step = step});
            const std::string where = std::to_string(i) + ", step " + std::to_string(step);
            EXPECT_LE(result.bounds.lower, high) << where;
            EXPECT_GE(result.bounds.upper, low) << where;
            EXPECT_LE(result.bounds.gap(), 0.5774 * step * diagonal(a) + 1e-13) << where;
            EXPECT_EQ(to_string(result.status), "budget") << where;
            EXPECT_NE(result.note, "") << where;
        }
    }
}

// The grid of half the step contains all points of the full step, so the lower bound cannot fall.
TEST(Sampling, HalfTheStepNeverFindsLess) {
    Random random(6);
    for (int i = 0; i < 100; ++i) {
        const Triangle a = i % 4 == 0 ? thin(random, 1e-6, 0.4) : any(random);
        const Scene scene = one_triangle(a, {random.vector(), random.vector(), random.vector()});
        const std::int64_t n = 2 + random.below(5);
        double lower = 0;
        for (int halved = 0; halved < 4; ++halved) {
            const Result result = solve(scene, {.step = std::ldexp(step_for(a, n), -halved)});
            EXPECT_GE(result.bounds.lower, lower - 1e-14) << i;
            EXPECT_LE(result.bounds.gap(),
                      std::ldexp(longest_edge_of(a) / (static_cast<double>(n) * std::sqrt(3)), -halved) + 1e-14)
                << i;
            lower = result.bounds.lower;
        }
    }
}

// A grid must never give a wider interval than the vertices alone.
TEST(Sampling, NeverWiderThanByVertices) {
    Random random(7);
    for (int i = 0; i < 100; ++i) {
        const Scene scene{soup(cloud(random, 6)), points_as_triangles({random.vector(), random.vector()})};
        const Result vertices = solve(scene, {.budget = 0});
        for (const double step : {0.9, 0.5, 0.3, 0.1}) {
            const Result result = solve(scene, {.step = step});
            EXPECT_LE(result.bounds.upper, vertices.bounds.upper) << i;
            EXPECT_GE(result.bounds.lower, vertices.bounds.lower) << i;
        }
    }
}

// Bounds must include the derived rounding error of samples, although roundings never all err in one direction.
TEST(Sampling, BoundsAreWidenedByTheRoundingOfSamples) {
    const Triangle a{{1, 1, 1}, {1 - 0x1p-20, 1, 1}, {1, 1 - 0x1p-20, 1}};
    const Vec3 b(1 - 0x1p-22, 1 - 0x1p-22, 1 - 0x1p-16);  // nearest to an inner point; the corners are farther
    const std::int64_t n = 64;
    const Scene corner = one_triangle(a, {b});
    const Result result = solve(corner, {.step = step_for(a, n)});
    // The farthest sample is a corner, which is exact, so its bound needs no such term.
    EXPECT_LE(result.bounds.upper - result.bounds.lower, 0x1p-19 / 64 + 30 * unit_roundoff);

    // B consists of the corners, so inner samples are farthest.
    const Result inner = solve(one_triangle(a, {a.a, a.b, a.c}), {.step = step_for(a, n)});
    Rational farthest = 0;
    for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= n - i; ++j) {
            const RVec3 p = combination(a, Rational(i) / n, Rational(j) / n, Rational(n - i - j) / n);
            Rational least = exact::squared_distance(p, exact::vector(a.a));
            for (const Vec3& v : {a.b, a.c}) least = std::min(least, exact::squared_distance(p, exact::vector(v)));
            farthest = std::max(farthest, least);
        }
    }
    const long double at_samples = exact::root(farthest),
                      radius = exact::root(squared_longest_edge(a)) / (n * std::sqrt(3.0L));
    EXPECT_GE(inner.bounds.upper, at_samples + radius + 15.5L * unit_roundoff);
    EXPECT_LE(inner.bounds.upper, at_samples + radius + 17.5L * unit_roundoff);
    EXPECT_LE(inner.bounds.lower, at_samples - 7.5L * unit_roundoff);
    EXPECT_GE(inner.bounds.lower, at_samples - 30 * unit_roundoff);
}

// Each vertex and each edge must be sampled once, even if several triangles share it.
TEST(Sampling, TheNumberOfSamplesIsAsDerived) {
    const TriangleMesh a = sheet(4, 0);  // 18 triangles of longest edge sqrt 2, 16 vertices, 33 edges
    for (const std::uint64_t n : {1, 2, 3, 10}) {
        const Scene scene{a, sheet(5, 1)};
        const double step = std::sqrt(2) / ((static_cast<double>(n) - 0.01) * diagonal(a.vertices));
        Counters counters = solve(scene, {.step = std::min(step, 1.0)}).counters;
        const std::uint64_t beside = 33 * (n - 1) + 18 * (n - 1) * (n - 2) / 2;
        EXPECT_EQ(counters.bound_tests, 36u);
        EXPECT_EQ(counters.closest_point_queries, 16 + beside + 2) << n << ", with the witness, certified and told";
        if (n < 2) continue;
        for (const std::uint64_t budget : {std::uint64_t{0}, std::uint64_t{1}, beside - 1}) {
            counters = solve(scene, {.step = step, .budget = budget}).counters;
            EXPECT_EQ(counters.closest_point_queries, 16 + budget + 2) << n;
        }
    }
}

TEST(Sampling, TheLongestEdgeDecidesTheNumberOfSteps) {
    const Vec3 corner[3] = {{0, 0, 0}, {0.5, 0.1, 0}, {1, 0, 0}};
    for (const std::size_t first : {0, 1, 2}) {
        const Triangle a{corner[first], corner[(first + 1) % 3], corner[(first + 2) % 3]};
        const Result result = solve(one_triangle(a, {{0, 0, 1}}), {.step = step_for(a, 10)});
        EXPECT_EQ(result.counters.closest_point_queries, 3u + 3 * 9 + 9 * 8 / 2 + 2) << first;
    }
}

// If two triangles divide a shared edge into different numbers of steps, the edge is sampled for each, so that both
// grids are complete.
TEST(Sampling, TrianglesOfDifferentSizesAreWhole) {
    Points points = rows({{0, 0, 0}, {1, 0, 0}, {0.5, 0.2, 0}, {0.5, -3, 0}});
    TriangleMesh a{points, Triangles(3, 3)};
    a.triangles << 0, 1, 2, 1, 0, 3, 2, 1, 0;
    const Result result = solve({a, points_as_triangles({{0, 0, 0}, {1, 0, 0}})}, {.step = 0.02, .fields = true});
    const auto [low, high] =
        MeshReference(points_as_triangles({{0, 0, 0}, {1, 0, 0}})).hausdorff(points, a.triangles.row(0), 1e-6L);
    ASSERT_TRUE(result.fields);
    const Fields& fields = *result.fields;
    for (const std::size_t i : {0, 2}) {
        EXPECT_LE(fields[0].values[i], high);
        EXPECT_GE(fields[1].values[i], low);
        EXPECT_GE(fields[0].values[i], low - 0.05L) << "samples that another triangle has measured count";
        EXPECT_EQ(fields[2].name, "steps");
        EXPECT_EQ(fields[2].values[i], std::ceil(1 / (0.02 * diagonal(points))));
    }
    EXPECT_GT(fields[2].values[1], 3 * fields[2].values[0]);
    const auto steps = [&](std::size_t i) { return static_cast<std::uint64_t>(fields[2].values[i]); };
    const auto inside = [&](std::uint64_t n) { return (n - 1) * (n - 2) / 2; };
    // The third triangle samples the edge again that it shares with the second, which has another number of steps.
    const std::uint64_t beside = 4 * (steps(0) - 1) + 2 * inside(steps(0)) + 3 * (steps(1) - 1) + inside(steps(1));
    EXPECT_EQ(result.counters.closest_point_queries, 4 + beside + 2);
}

TEST(Sampling, FieldsHoldOfEachTriangleWhereverItStops) {
    Random random(8);
    for (int i = 0; i < 60; ++i) {
        const Points a = cloud(random, 12);
        const TriangleMesh source = soup(a), target = soup(cloud(random, 9));
        const std::vector<Request> all{{.fields = true},
                                       {.budget = 40, .fields = true},
                                       {.floor = 0.5, .fields = true},
                                       {.cutoff = 0.2, .fields = true},
                                       {.time_limit = 1e-12, .fields = true}};
        for (const Request& request : all) {
            const Result result = solve({source, target}, request);
            ASSERT_TRUE(result.fields);
            for (Index t = 0; t < source.triangles.rows(); ++t) {
                const auto [low, high] = MeshReference(target).hausdorff(a, source.triangles.row(t), 1e-2L);
                const auto at = static_cast<std::size_t>(t);
                EXPECT_LE((*result.fields)[0].values[at], high) << i;
                EXPECT_GE((*result.fields)[1].values[at], low) << i;
                EXPECT_LE((*result.fields)[0].values[at], result.bounds.lower) << i;
                if (request.floor == 0) {
                    EXPECT_LE((*result.fields)[1].values[at], result.bounds.upper) << i;
                }
            }
        }
    }
}

TEST(Sampling, StopsWhereItMay) {
    Random random(9);
    const TriangleMesh a = soup(cloud(random, 30)), b = soup(cloud(random, 30));
    const Result whole = solve({a, b}, {.step = 0.02});
    EXPECT_EQ(to_string(whole.status), "budget");
    const auto stops = [&](Request request, const char* status) {
        request.step = 0.02;
        const Result result = solve({a, b}, request);
        EXPECT_EQ(to_string(result.status), status);
        EXPECT_LE(result.bounds.lower, whole.bounds.upper);
        EXPECT_GE(result.bounds.upper, whole.bounds.lower);
        return result.counters.closest_point_queries;
    };
    const std::uint64_t all = whole.counters.closest_point_queries;
    EXPECT_LT(stops({.cutoff = 0.5 * whole.bounds.lower}, "above_cutoff"), all / 4);
    EXPECT_LT(stops({.floor = whole.bounds.upper + 0.7}, "below_floor"), all / 2)
        << "only what is above the floor is sampled";
    EXPECT_LT(stops({.budget = 5}, "budget"), 50u);
    EXPECT_LT(stops({.time_limit = 1e-12}, "time_limit"), 50u);
    EXPECT_EQ(stops({.tolerance = 1}, "converged"), all) << "no tolerance ends it";
}

// The time limit must also end the search inside one huge triangle.
TEST(Sampling, TimeEndsInsideATriangle) {
    const Triangle a{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const Result result = solve(one_triangle(a, {{0, 0, 1}, {1, 1, 0}}), {.step = 1e-6, .time_limit = 0.02});
    EXPECT_EQ(to_string(result.status), "time_limit");
    expect_holds(result, exact_squared(a, {{0, 0, 1}, {1, 1, 0}}), "stopped");
}

TEST(Sampling, PointsAreExactToRounding) {
    Random random(10);
    const Points points = cloud(random, 50), others = cloud(random, 40);
    const PointSet a{points}, b{others};
    const Result coarse = solve({a, b}, {.step = 1}), fine = solve({a, b}, {.step = 0.001});
    EXPECT_EQ(coarse.bounds.lower, fine.bounds.lower);
    EXPECT_EQ(coarse.bounds.upper, fine.bounds.upper);
    EXPECT_LT(fine.bounds.gap(), 1e-14);
    EXPECT_EQ(to_string(fine.status), "precision_floor") << "no step would be finer";
    EXPECT_EQ(to_string(solve({a, b}, {.tolerance = 1e-9}).status), "converged");
    expect_holds(fine, exact_squared_hausdorff(points, others), "points");
}

// The bounds must include the rounding of both shapes' coordinates, even if one shape is at the origin.
TEST(Sampling, TheCoordinatesOfBothShapesCount) {
    const PointSet origin{rows({{0, 0, 0}})}, far{rows({{1, 0, 0}})};
    for (const Scene& scene : {Scene{origin, far}, Scene{far, origin}}) {
        const Result result = solve(scene, {});
        EXPECT_GE(result.bounds.upper, 1 + 8 * unit_roundoff);
        EXPECT_LE(result.bounds.lower, 1);
        EXPECT_LE(result.bounds.gap(), 40 * unit_roundoff);
    }
}

TEST(Sampling, TracesHoldAndGetTighter) {
    Random random(11);
    const TriangleMesh a = soup(cloud(random, 60)), b = soup(cloud(random, 90));
    Trace trace(Trace::Mode::on);
    const Result result = solve({a, b}, {.step = 0.02}, trace);
    ASSERT_GE(trace.samples().size(), 3u);
    Bounds last;
    for (const TraceSample& sample : trace.samples()) {
        EXPECT_GE(sample.lower, last.lower);
        EXPECT_LE(sample.upper, last.upper);
        EXPECT_LE(sample.lower, result.bounds.upper);
        EXPECT_GE(sample.upper, result.bounds.lower);
        last = {sample.lower, sample.upper};
    }
}

}  // namespace
}  // namespace hausbench
