// Threshold cover: its interval against exact samples and the other solvers, hostile meshes, and termination.
#include "algorithms/meshes/cover/offset_cover.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/exact.h"
#include "tests/support/metamorphic.h"
#include "tests/support/scenes.h"
#include "tests/support/small_scenes.h"
#include "tests/support/tree_meshes.h"

#include <hwy/targets.h>

#include <thread>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using namespace cover;

// Local units for the cube [-1, 1]^3, and a cover that holds all triangles of a mesh.
struct Place {
    LocalUnits units;
    OffsetCover<double> exact;
    explicit Place(const TriangleMesh& mesh) {
        Box box;
        box.add(Vec3(-1, -1, -1));
        box.add(Vec3(1, 1, 1));
        units.set(box, 1e-30);
        exact.near.clear(units);
        std::vector<Index> all(static_cast<std::size_t>(mesh.triangles.rows()));
        for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
        set_frames(mesh, all, exact.near);
    }
};

// Measures a point's distance by trying all triangles of the mesh.
class Host final : public cover::Host {
public:
    Host(const TriangleMesh& mesh, const LocalUnits& units, double tolerance)
        : mesh_(mesh), units_(units), tolerance_(tolerance) {}

    Index measure(const double (&point)[3], double, Index) override {
        Vec3 global;
        for (int k = 0; k < 3; ++k) global[k] = units_.origin[k] + units_.unit * point[k];
        Counters counters;
        const ClosestPoint nearest = closest_by_scan(mesh_, global, {}, counters);
        lower = std::max(lower, std::sqrt(nearest.squared_distance));
        return nearest.triangle;
    }
    double threshold() const override { return (lower + tolerance_) * units_.inverse; }
    bool promising(double distance) const override { return distance * units_.unit > lower + 0.2 * tolerance_; }
    bool go_on() override { return ++work < most_work; }

    double lower = 0;
    std::size_t work = 0, most_work = 20000;

private:
    const TriangleMesh& mesh_;
    const LocalUnits& units_;
    double tolerance_;
};

double largest_of_samples(const Triangle& t, const TriangleMesh& mesh, int n) {
    double most = 0;
    Counters counters;
    for (int i = 0; i <= n; ++i) {
        for (int j = 0; i + j <= n; ++j) {
            const Vec3 point = t.a + (t.b - t.a) * (double(i) / n) + (t.c - t.a) * (double(j) / n);
            most = std::max(most, std::sqrt(closest_by_scan(mesh, point, {}, counters).squared_distance));
        }
    }
    return most;
}

TEST(OffsetCover, BoundsAPieceFromAboveAndEnds) {
    Random random(41);
    for (int i = 0; i < 400; ++i) {
        const TriangleMesh mesh = triangle_soup(random, 1 + random.below(12), i % 3 == 0 ? 0.1 : 0.6);
        Place place(mesh);
        Host host(mesh, place.units, i % 2 == 0 ? 1e-3 : 1e-7);
        const Triangle t{0.5 * random.vector(), 0.5 * random.vector(), 0.5 * random.vector()};
        cover::Polygon<double> polygon;
        for (const Vec3* corner : {&t.a, &t.b, &t.c}) {
            const Vec3 local = *corner * place.units.inverse;
            polygon.add(local[0], local[1], local[2], 0);
        }
        place.exact.set_threshold(host.threshold());
        const CoverResult result = cover_surely(place.exact, polygon, host, mesh);
        ASSERT_TRUE(result.covered) << i;
        const double upper = result.upper * place.units.unit, sampled = largest_of_samples(t, mesh, 24);
        EXPECT_GE(upper, std::max(sampled, host.lower) * (1 - 1e-14)) << i;
        EXPECT_LT(host.work, host.most_work) << i;
        EXPECT_LE(upper, host.lower + (i % 2 == 0 ? 1e-3 : 1e-7) + 1e-12) << i;
    }
}

// The work limit is reached early: every remaining part still has a valid bound.
TEST(OffsetCover, BoundsHoldWhereWorkIsSpent) {
    Random random(42);
    for (int i = 0; i < 200; ++i) {
        const TriangleMesh mesh = triangle_soup(random, 8, 0.3);
        Place place(mesh);
        Host host(mesh, place.units, 1e-6);
        host.most_work = static_cast<std::size_t>(1 + random.below(30));
        const Triangle t{0.5 * random.vector(), 0.5 * random.vector(), 0.5 * random.vector()};
        cover::Polygon<double> polygon;
        for (const Vec3* corner : {&t.a, &t.b, &t.c}) {
            const Vec3 local = *corner * place.units.inverse;
            polygon.add(local[0], local[1], local[2], 0);
        }
        place.exact.set_threshold(host.threshold());
        const CoverResult result = cover_surely(place.exact, polygon, host, mesh);
        ASSERT_TRUE(result.covered);
        EXPECT_GE(result.upper * place.units.unit, largest_of_samples(t, mesh, 16) * (1 - 1e-14)) << i;
    }
}

// In single precision too, no bound is below the exact distance, because it includes the rounding error. B is one
// triangle, so the farthest point is a corner, known exactly.
TEST(OffsetCover, SinglePrecisionNeverBoundsBelowTheExactDistance) {
    Random random(43);
    double closest_call = 1;
    for (int i = 0; i < 3000; ++i) {
        const TriangleMesh mesh = triangle_soup(random, 1, 0.6);
        const TriangleBlocks blocks(mesh);
        Box box;
        const Triangle t{0.5 * random.vector(), 0.5 * random.vector(), 0.5 * random.vector()};
        for (const Vec3* corner : {&t.a, &t.b, &t.c}) box.add(*corner);
        LocalUnits place;
        place.set(box, 1e-30);
        OffsetCover<float> cover;
        cover.near.clear(place);
        Counters counters;
        blocks.gather(Vec3::Zero(), 10, cover.near, counters);
        ASSERT_EQ(cover.near.count(), 1U);
        cover.make_rows(most_shared_points + most_polygon_corners + 4);
        cover.set_threshold(8 * place.inverse);
        cover::LocalPoints<float> points;
        cover::Polygon<float> piece;
        long double farthest = 0;
        const Triangle b = triangle_of(mesh, 0);
        for (const Vec3* corner : {&t.a, &t.b, &t.c}) {
            float local[3];
            for (int k = 0; k < 3; ++k) local[k] = static_cast<float>(((*corner)[k] - place.origin[k]) * place.inverse);
            points.x[points.count] = local[0], points.y[points.count] = local[1], points.z[points.count++] = local[2];
            piece.add(local[0], local[1], local[2], 0);
            farthest = std::max(
                farthest, exact::root(exact::squared_distance_to_triangle(exact::vector(*corner), exact::vector(b.a),
                                                                          exact::vector(b.b), exact::vector(b.c))));
        }
        measure_shared(cover, points);
        const CoverResult result = cover_shared(cover, piece, {0, 1, 2}, 48);
        ASSERT_TRUE(result.covered);
        const double upper = result.upper * place.unit;
        EXPECT_GE(upper, static_cast<double>(farthest)) << i;
        EXPECT_LE(upper, static_cast<double>(farthest) + 1e-4) << i;
        closest_call = std::min(closest_call, upper - static_cast<double>(farthest));
    }
    EXPECT_LT(closest_call, 1e-4);
}

// Random scenes must give the same bits with 1, 2 and 5 threads, even if a budget ends the search.
TEST(Cover, TheAnswerDoesNotDependOnTheNumberOfThreads) {
    Random random(44);
    const SolverEntry& entry = find_solver("cover");
    for (int i = 0; i < 12; ++i) {
        const TriangleMesh a = triangle_grid(random, 30, 0.05), b = triangle_grid(random, 25, 0.07);
        std::optional<Result> first;
        for (const int threads : {1, 2, 5}) {
            Query query;
            query.tolerance.value = i % 3 == 0 ? 1e-3 : 1e-7;
            query.threads = threads;
            if (i % 4 == 3) query.budget = 500;
            QuerySet queries;
            queries.threads = threads;
            Trace trace;
            const Result result = Session(entry, Options("cover", {}, {}), Scene{a, b}, queries).solve(query, trace);
            if (!first) first = result;
            EXPECT_EQ(result.bounds.lower, first->bounds.lower) << i << ", " << threads;
            EXPECT_EQ(result.bounds.upper, first->bounds.upper) << i << ", " << threads;
            EXPECT_EQ(result.witness.source_point, first->witness.source_point) << i;
            EXPECT_EQ(result.counters, first->counters) << i << ", " << threads;
            EXPECT_EQ(result.status, i % 4 == 3 ? first->status : Status::converged) << i;
        }
    }
}

Result answer(const TriangleMesh& a, const TriangleMesh& b, const Query& query) {
    Trace trace;
    return Session(find_solver("cover"), Options("cover", {}, {}), Scene{a, b}, {}).solve(query, trace);
}

// Buffers for covering are kept from one solve to the next. An answer must not depend on earlier solves.
TEST(Cover, RoomsThatAreUsedAgainChangeNothing) {
    const SolverEntry& entry = find_solver("cover");
    Random random(11);
    std::vector<Scene> scenes;
    for (const Index n : {12, 90, 600}) scenes.push_back({soup(cloud(random, 3 * n)), soup(cloud(random, 3 * n, 0.5))});
    const auto solve = [&](const Scene& scene, double tolerance, bool certificate, std::uint64_t budget, int threads) {
        QuerySet queries;
        queries.threads = threads;
        const Session session(entry, Options("cover", entry.info.parameters, {}), scene, queries);
        Query query;
        query.tolerance = {Tolerance::Of::absolute, tolerance};
        query.wanted.certificate = certificate;
        query.budget = budget;
        query.threads = threads;
        Trace untraced;
        return session.solve(query, untraced);
    };
    constexpr std::uint64_t no_budget = std::numeric_limits<std::uint64_t>::max();
    std::vector<Result> first;
    std::thread([&] {  // its buffers are new
        for (const Scene& scene : scenes) first.push_back(solve(scene, 1e-6, false, no_budget, 1));
    })
        .join();
    for (int round = 0; round < 3; ++round) {
        for (std::size_t i = 0; i < scenes.size(); ++i) {
            (void)solve(scenes[(i + 1) % 3], 1e-9, true, no_budget, 1);
            (void)solve(scenes[(i + 2) % 3], 1e-9, false, 3, 1);  // ends in the middle of the work
            (void)solve(scenes[(i + 1) % 3], 1e-4, false, no_budget, 2);
            const Result again = solve(scenes[i], 1e-6, false, no_budget, 1);
            EXPECT_EQ(again.bounds.lower, first[i].bounds.lower);
            EXPECT_EQ(again.bounds.upper, first[i].bounds.upper);
            EXPECT_EQ(again.witness.source_point, first[i].witness.source_point);
            EXPECT_EQ(again.counters, first[i].counters);
        }
    }
}

TEST(Cover, TheAnswerDoesNotDependOnTheInstructionSet) {
    Random random(46);
    int compared = 0;
    for (int i = 0; i < 6; ++i) {
        const TriangleMesh a = triangle_grid(random, 25, 0.05),
                           b = i % 2 == 0 ? triangle_grid(random, 40, 0.07) : triangle_soup(random, 400, 0.3);
        Query query;
        query.tolerance.value = i % 3 == 0 ? 1e-3 : 1e-8;
        std::optional<Result> first;
        for (const auto target : hwy::SupportedAndGeneratedTargets()) {
            hwy::SetSupportedTargetsForTest(target);
            hwy::GetChosenTarget().Update(hwy::SupportedTargets());
            const Result result = answer(a, b, query);
            hwy::SetSupportedTargetsForTest(0);
            hwy::GetChosenTarget().Update(hwy::SupportedTargets());
            if (!first) {
                first = result;
                continue;
            }
            ++compared;
            const char* const where = hwy::TargetName(target);
            EXPECT_EQ(result.bounds.lower, first->bounds.lower) << where;
            EXPECT_EQ(result.bounds.upper, first->bounds.upper) << where;
            EXPECT_EQ(result.witness.source_point, first->witness.source_point) << where;
            EXPECT_EQ(result.counters, first->counters) << where;
        }
    }
    EXPECT_GE(compared, 6);
}

// The first measured points lie on B, so a tolerance relative to the lower bound is 0 at first.
TEST(Cover, ARelativeToleranceMayBeginAtZero) {
    const auto mesh = [](std::initializer_list<std::array<double, 3>> vertices,
                         std::initializer_list<std::array<Index, 3>> triangles) {
        TriangleMesh made;
        made.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 3);
        made.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
        Eigen::Index row = 0;
        for (const auto& v : vertices) made.vertices.row(row++) << v[0], v[1], v[2];
        row = 0;
        for (const auto& t : triangles) made.triangles.row(row++) << t[0], t[1], t[2];
        return made;
    };
    const TriangleMesh square = mesh({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
    const TriangleMesh tent = mesh({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0.3}},
                                   {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
    Query query;
    query.tolerance = {Tolerance::Of::lower, 0.01};
    const Result result = answer(square, tent, query);
    EXPECT_EQ(result.status, Status::converged);
    EXPECT_NEAR(result.bounds.upper, 0.2572478777137604, 0.003);
}

// A triangle of B is so small that the squares of its edges underflow. The computed distance must not become shorter.
TEST(Cover, ATinyTriangleIsNoNearerThanItIs) {
    const TriangleMesh a = soup(rows({{0.25, 0, 0}, {0.262, 0, 0}, {0.262, 0.012, 0}}));
    for (int exponent = -1074; exponent <= -400; ++exponent) {
        for (const double factor : {1.0, 1.4}) {
            const double s = factor * std::ldexp(1.0, exponent);
            const TriangleMesh b =
                soup(rows({{-s / 2, 0, 0}, {s / 2, 0, 0}, {0, s / 8, 0}, {-1, -0.1, 0}, {-1, 0.1, 0}, {-1, 0, 0.1}}));
            Query query;
            query.tolerance = {Tolerance::Of::absolute, 1e-9};
            const Result result = answer(a, b, query);
            EXPECT_EQ(result.status, Status::converged) << s;
            const double h = 0.26227466518899617;  // to the next double: B's triangle is far smaller than one ulp
            EXPECT_LE(result.bounds.lower, std::nextafter(h, 1)) << s;
            EXPECT_GE(result.bounds.upper, std::nextafter(h, 0)) << s;
        }
    }
}

// All points of A are equally far from B, so no part can be discarded. A distance above the cutoff must still end the
// search.
TEST(Cover, ADistanceAboveTheCutoffEndsTheSearch) {
    TriangleMesh a = soup(rows({{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}));
    const TriangleMesh b = soup(rows({{-9, -9, 0}, {9, -9, 0}, {0, 20, 0}}));
    for (const double floor : {0.5, 0.0}) {
        Query query;
        query.tolerance = {Tolerance::Of::absolute, 1e-12};
        query.floor = floor;
        query.cutoff = 0.5;
        query.time_limit = 5;
        const Result result = answer(a, b, query);
        EXPECT_EQ(result.status, Status::above_cutoff);
        EXPECT_GT(result.bounds.lower, 0.999);
        EXPECT_GE(result.bounds.upper, 1);
        EXPECT_LT(result.counters.subdivisions, 100U);
    }
}

// The corners of A lie on B; the largest distance, which is far above the cutoff, is inside A.
TEST(Cover, ADistanceAboveTheCutoffSavesTheRestOfTheSearch) {
    const TriangleMesh a = soup(rows({{0, 0, 0}, {10, 0, 0}, {3, 8, 0}}));
    const TriangleMesh b = soup(rows(
        {{0, 0, 0}, {-1, 0, 1}, {0, -1, 1}, {10, 0, 0}, {11, 0, 1}, {10, -1, 1}, {3, 8, 0}, {3, 9, 1}, {2, 8, 2}}));
    Query query;
    query.tolerance = {Tolerance::Of::absolute, 1e-9};
    const Result whole = answer(a, b, query);
    query.cutoff = 0.5;
    const Result result = answer(a, b, query);
    EXPECT_EQ(result.status, Status::above_cutoff);
    EXPECT_LT(10 * result.counters.subdivisions, whole.counters.subdivisions);
}

// Corners of a triangle are at the length itself, where rounding leaves the answer open. The corner far above it decides.
TEST(Cover, CornersAtTheCutoffDoNotHideOneAboveIt) {
    const TriangleMesh b = soup(rows({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    std::array<int, 3> order{0, 1, 2};
    const Vec3 corners[] = {{0, 0, 1}, {0, 1, 1}, {50, 0, 1}};
    do {
        Points points(3, 3);
        for (int k = 0; k < 3; ++k) points.row(k) = corners[order[std::size_t(k)]];
        Query query;
        query.tolerance = {Tolerance::Of::absolute, 1e-6};
        query.floor = query.cutoff = 1;
        const Result result = answer(soup(points), b, query);
        EXPECT_EQ(result.status, Status::above_cutoff);
        EXPECT_GT(result.bounds.lower, 49);
    } while (std::next_permutation(order.begin(), order.end()));
}

// A triangle of A at exactly the cutoff from a parallel triangle of B, and partly nearer to two others, as on surfaces of voxels
// one voxel apart. The question stays open, which must not take millions of cuts.
TEST(Cover, ATieWithTheCutoffEndsSoon) {
    const TriangleMesh a = soup(rows({{7.5, 8, 7}, {7.5, 7, 6}, {7.5, 7, 7}}));
    const TriangleMesh b = soup(rows({{8, 8, 5.5},
                                      {7, 8, 5.5},
                                      {8, 7, 5.5},
                                      {8, 8, 7.5},
                                      {8, 7, 7.5},
                                      {7, 8, 7.5},
                                      {8.5, 8, 7},
                                      {8.5, 7, 6},
                                      {8.5, 7, 7}}));
    for (const double away : {0.0, 1e-15, -1e-15, 1e-12, -1e-12}) {
        Query query;
        query.tolerance = {Tolerance::Of::absolute, 1e-6};
        query.time_limit = 60;
        query.floor = query.cutoff = 1 + away;
        const Result result = answer(a, b, query);
        EXPECT_LT(result.counters.subdivisions, 2000U) << away;
        EXPECT_EQ(result.status, away >= 1e-12    ? Status::below_floor
                                 : away <= -1e-12 ? Status::above_cutoff
                                                  : Status::precision_floor)
            << away;
    }
}

// Tolerances that double precision cannot meet: the search ends near the best possible interval,
// and "is h above d?" is answered.
TEST(Cover, EndsWhereTheToleranceIsBelowTheRounding) {
    Random random(45);
    TriangleMesh mesh = triangle_grid(random, 20, 0.2);
    for (const double offset : {0.0, 1e6}) {
        mesh.vertices.array() += offset;
        Query query;
        query.time_limit = 60;
        query.tolerance = {Tolerance::Of::lower, 0.01};
        Result result = answer(mesh, mesh, query);
        EXPECT_EQ(result.status, Status::precision_floor) << offset;
        EXPECT_LE(result.bounds.upper, 1e-10 + 1e-14 * offset);
        EXPECT_LT(result.counters.subdivisions, 2000U);
        query.tolerance = {Tolerance::Of::absolute, 1e-18};
        EXPECT_EQ(answer(mesh, mesh, query).status, Status::precision_floor);
        query.floor = query.cutoff = 1e-6;
        EXPECT_EQ(answer(mesh, mesh, query).status, Status::below_floor);
    }
}

// Tolerances far below the errors of single precision: a mesh and itself need hardly any closest points, because the
// triangle of B that seems nearest to a triangle of A is tried in double precision.
TEST(Cover, EqualMeshesNeedFewQueriesBelowSinglePrecision) {
    Random random(46);
    const TriangleMesh mesh = triangle_grid(random, 20, 0.2);
    for (const double tolerance : {1e-8, 1e-10, 1e-13}) {
        Query query;
        query.tolerance = {Tolerance::Of::absolute, tolerance};
        const Result result = answer(mesh, mesh, query);
        EXPECT_EQ(result.status, Status::converged);
        EXPECT_LE(result.bounds.upper, tolerance);
        EXPECT_LT(result.counters.closest_point_queries, static_cast<std::uint64_t>(mesh.triangles.rows()) / 4);
    }
}

// Above them, too, the upper bound is what rounding in double precision leaves, because it costs nothing. At some tolerances
// the errors of single precision nearly reach the threshold: then not all corners of a piece are within it of the equal triangle.
TEST(Cover, AMeshAgainstItselfHasNoErrorsOfSinglePrecision) {
    Random random(46);
    const TriangleMesh mesh = triangle_grid(random, 20, 0.2);
    for (double tolerance = 1e-6; tolerance < 1e-3; tolerance *= 1.1) {
        for (const bool more : {false, true}) {
            Query query;
            query.tolerance = {Tolerance::Of::absolute, tolerance};
            query.wanted.certificate = query.wanted.fields = more;
            const Result result = answer(mesh, mesh, query);
            EXPECT_EQ(result.status, Status::converged);
            EXPECT_LE(result.bounds.upper, 64 * unit_roundoff * magnitude(mesh.vertices)) << tolerance;
            EXPECT_EQ(result.certificates.size(), more ? 1U : 0U);
        }
    }
}

// With such tolerances, a triangle of B that seems to cover a piece may be too far away. The answer must still be within the
// tolerance.
TEST(Cover, NearlyEqualMeshesBelowSinglePrecisionAreMeasuredToTheTolerance) {
    Random random(47);
    const TriangleMesh mesh = triangle_grid(random, 20, 0.2);
    TriangleMesh moved = mesh;
    for (Eigen::Index i = 0; i < moved.vertices.rows(); ++i) moved.vertices.row(i) += 1e-8 * random.vector();
    Query query;
    query.tolerance = {Tolerance::Of::absolute, 1e-11};
    const Result result = answer(mesh, moved, query);
    EXPECT_EQ(result.status, Status::converged);
    EXPECT_GT(result.bounds.lower, 1e-10);
    EXPECT_LE(result.bounds.upper, result.bounds.lower + 1e-11);
}

// One vertex is pulled away, so that six triangles are needles. The small triangles that B has there are even thinner.
TEST(Cover, AFewCutsAreEnoughIfBIsARefinementOfA) {
    Random random(48);
    for (const double pulled : {1.0, 3.0, 100.0, 1e4}) {
        TriangleMesh a = triangle_grid(random, 10, 0.01);
        a.vertices.row(a.vertices.rows() / 2 + 5) *= pulled;
        const TriangleMesh b = mesh_of(metamorphic::subdivided(a));
        for (const double tolerance : {1e-6, 1e-8, 1e-9, 1e-11}) {
            Query query;
            query.tolerance.value = tolerance * std::max(pulled, 1.0);
            const Result result = answer(a, b, query);
            EXPECT_LE(result.bounds.upper, query.tolerance.value) << pulled << ", " << tolerance;
            EXPECT_LE(result.counters.subdivisions, 20 * static_cast<std::uint64_t>(a.triangles.rows()))
                << pulled << ", " << tolerance;
        }
    }
}

// Along the middle of a hole with parallel edges, the distance is constant, so pieces must be cut there to within the
// tolerance. Few cuts must suffice, even at tolerances near rounding.
TEST(Cover, AFewCutsAreEnoughAlongARidge) {
    Random random(47);
    for (int scene = 0; scene < 40; ++scene) {
        const TriangleMesh a = triangle_grid(random, 12, scene % 2 == 0 ? 0 : 1e-4);
        TriangleMesh holes = a;
        Index kept = 0;
        for (Index i = 0; i < a.triangles.rows(); ++i)
            if (random.below(2) == 0 || kept == 0) holes.triangles.row(kept++) = a.triangles.row(i);
        holes.triangles.conservativeResize(kept, 3);
        for (const double tolerance : {1e-9, 1e-11, 1e-12}) {
            Query query;
            query.tolerance = {Tolerance::Of::lower, tolerance};
            const Result result = answer(a, holes, query);
            EXPECT_LE(result.bounds.upper, result.bounds.lower * (1 + std::max(tolerance, 1e-10))) << scene;
            EXPECT_LE(result.counters.subdivisions, 20000U) << scene << ", " << tolerance;
        }
    }
}

}  // namespace
}  // namespace hausbench
