// The promises of solvers of algebraic surfaces, on pairs with known distances, and the numbers of Shou 2014.
#include "algorithms/error.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "algorithms/surfaces/surface_mesh.h"

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <thread>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

AlgebraicSurface surface(const std::string& polynomial, double size = 2) {
    AlgebraicSurface s{polynomial, Points(2, 3)};
    s.box.row(0).setConstant(-size);
    s.box.row(1).setConstant(size);
    return s;
}

const AlgebraicSurface cone_1 = surface("x^2/4 + y^2/4 - z^2/9"), cone_2 = surface("x^2/16 + y^2/4 - z^2/9");
const double h_cones = 0.79885958582385, true_h = std::sqrt(43.0) / 3 - 4.0 / 3;

Session session_of(const std::string& solver, const AlgebraicSurface& a, const AlgebraicSurface& b,
                   const ParameterMap& given = {}) {
    const SolverEntry& entry = find_solver(solver);
    return Session(entry, Options(entry.info.name, entry.info.parameters, given), {a, b}, {});
}

Result solve(const std::string& solver, const AlgebraicSurface& a, const AlgebraicSurface& b, double tolerance,
             const ParameterMap& given = {}, double seconds = 10) {
    Query query;
    query.tolerance = {Tolerance::Of::absolute, tolerance};
    query.time_limit = seconds;
    Trace trace;
    return session_of(solver, a, b, given).solve(query, trace);
}

ParameterMap subdivision(int depth, const std::string& pairs, const std::string& form = "modified_affine") {
    return {{"depth", std::int64_t(depth)}, {"pairs", pairs}, {"form", form}};
}

Bounds published(int depth, const std::string& pairs, const std::string& form = "modified_affine") {
    const Bounds first = solve("interval_subdivision", cone_1, cone_2, 100, subdivision(depth, pairs, form)).bounds;
    const Bounds second = solve("interval_subdivision", cone_2, cone_1, 100, subdivision(depth, pairs, form)).bounds;
    return {std::max(first.lower, second.lower), std::max(first.upper, second.upper)};
}

TEST(IntervalSubdivision, GivesThePapersInterval) {
    const Bounds all = published(6, "all"), pruned = published(6, "pruned");
    EXPECT_NEAR(all.lower, std::sqrt(17.0) / (4 * std::sqrt(2.0)), 1e-12);
    EXPECT_NEAR(all.upper, std::sqrt(103.0) / (8 * std::sqrt(2.0)), 1e-12);
    EXPECT_EQ(all.lower, pruned.lower);
    EXPECT_EQ(all.upper, pruned.upper);
    // The midpoint and the half-width as the paper prints them, to their last digits.
    EXPECT_NEAR((all.lower + all.upper) / 2, 0.81295637135, 1e-10);
    EXPECT_NEAR((all.upper - all.lower) / 2, 0.08408738455, 1e-10);
}

TEST(IntervalSubdivision, ConvergesOnThePapersPair) {
    const double widths[] = {0.1682, 0.0835, 0.0422};
    for (int depth = 6; depth <= 8; ++depth) {
        const Bounds b = published(depth, "pruned");
        EXPECT_LE(b.lower, true_h) << depth;
        EXPECT_GE(b.upper, true_h) << depth;
        EXPECT_NEAR(b.gap(), widths[depth - 6], 1e-4) << depth;
    }
}

TEST(IntervalSubdivision, PruningChangesNoBitAndSavesAThousandfold) {
    for (const std::string form : {"natural", "centred", "affine", "modified_affine"}) {
        const Bounds all = published(4, "all", form), pruned = published(4, "pruned", form);
        EXPECT_EQ(all.lower, pruned.lower) << form;
        EXPECT_EQ(all.upper, pruned.upper) << form;
    }
    const AlgebraicSurface sphere = surface("(x - 1/3)^2 + y^2 + z^2 - 2"),
                           torus = surface("(x^2 + y^2 + z^2 + 3/4)^2 - 4*(x^2 + y^2)");
    for (const auto& [a, b] : {std::pair{sphere, torus}, {torus, sphere}, {cone_1, sphere}, {sphere, sphere}}) {
        const Result all = solve("interval_subdivision", a, b, 100, subdivision(5, "all")),
                     pruned = solve("interval_subdivision", a, b, 100, subdivision(5, "pruned"));
        EXPECT_EQ(all.bounds.lower, pruned.bounds.lower);
        EXPECT_EQ(all.bounds.upper, pruned.bounds.upper);
    }
    for (const auto& [a, b] : {std::pair{cone_1, cone_2}, {cone_2, cone_1}}) {
        const Result all = solve("interval_subdivision", a, b, 100, subdivision(6, "all")),
                     pruned = solve("interval_subdivision", a, b, 100, subdivision(6, "pruned"));
        EXPECT_GE(all.counters.box_distances, 1000 * pruned.counters.box_distances);
    }
}

TEST(IntervalSubdivision, MissesWhereVoxelsHoldNoSurface) {
    // The published lower bound takes these voxels, kept only because of rounding, for points of the source.
    const AlgebraicSurface almost = surface("(z^2 - 1/4)*(x^2 + y^2 + (z - 1)^2 + 1/1000)"),
                           plane = surface("z^2 - 1/4");
    const Result result = solve("interval_subdivision", almost, plane, 100, subdivision(6, "pruned"));
    const Result certified = solve("surface_enclosure", almost, plane, 1e-3);
    EXPECT_GT(result.bounds.lower, certified.bounds.upper);
    EXPECT_EQ(to_string(certified.status), "converged");
}

TEST(IntervalSubdivision, SaysWhyItStops) {
    const Result coarse = solve("interval_subdivision", cone_1, cone_2, 1e-3, subdivision(4, "all"));
    EXPECT_EQ(coarse.status, Status::stalled);
    EXPECT_NE(coarse.note.find("depth"), std::string::npos);
    EXPECT_TRUE(coarse.witness.source_point.array().isNaN().all());
}

struct Known {
    std::string name;
    AlgebraicSurface a, b;
    double h;  // from a to b
    double tolerance;
};

std::vector<Known> gallery() {
    const auto s = [](const std::string& text) { return surface(text); };
    const AlgebraicSurface ball = s("x^2 + y^2 + z^2 - 1");
    return {
        {"cones", cone_1, cone_2, h_cones, 1e-6},
        {"cones, the other way", cone_2, cone_1, true_h, 1e-6},
        {"concentric spheres", ball, s("x^2 + y^2 + z^2 - 9/4"), 0.5, 2e-3},
        {"offset spheres", ball, s("(x - 1/4)^2 + y^2 + z^2 - 1"), 0.25, 1e-5},
        {"sphere to torus", ball, s("(x^2 + y^2 + z^2 + 3/4)^2 - 4*(x^2 + y^2)"), std::sqrt(2.0) - 0.5, 1e-4},
        {"torus to sphere", s("(x^2 + y^2 + z^2 + 3/4)^2 - 4*(x^2 + y^2)"), ball, 0.5, 1e-3},
        {"ellipsoid to sphere", s("x^2/2.25 + y^2 + z^2 - 1"), ball, 0.5, 1e-5},
        {"parallel planes", s("z"), s("z - 1/2"), 0.5, 1e-9},
        {"slanted planes", s("z"), s("z - x/4"), std::sqrt(0.25 / 1.0625), 1e-6},
        {"tangent spheres", s("(x - 1/2)^2 + y^2 + z^2 - 1/4"), ball, 1, 5e-3},
        {"the same sphere", ball, s("2*x^2 + 2*y^2 + 2*z^2 - 2"), 0, 1e-3},
        {"cone to plane", cone_1, s("z"), 2, 1e-6},
        {"planes that cross to one of them", s("x*y"), s("x"), 2, 1e-6},
    };
}

TEST(SurfaceSolvers, CertifiedBoundsHoldAndClose) {
    for (const Known& k : gallery()) {
        const Result result = solve("surface_enclosure", k.a, k.b, k.tolerance);
        EXPECT_LE(result.bounds.lower, k.h * (1 + 1e-14) + 1e-15) << k.name;
        EXPECT_GE(result.bounds.upper, k.h * (1 - 1e-14) - 1e-15) << k.name;
        EXPECT_EQ(to_string(result.status), "converged")
            << k.name << ", gap " << result.bounds.gap() << ", " << result.note;
    }
}

// A cubed plane equation, multiplied out. Its values near the plane are mostly rounding errors, so points are proven to
// lie on it only to within about 1e-5, which the bounds must include.
TEST(SurfaceSolvers, APointThatIsKnownRoughlyIsNoFartherThanItsError) {
    AlgebraicSurface plane = surface("z");
    plane.box << -0x1p-10, -0x1p-10, -0.25, 0x1p-10, 0x1p-10, 0.25;
    for (int eighths = 3; eighths <= 13; ++eighths) {
        const std::string c = std::to_string(eighths) + "/8";
        const double h = eighths / 8.0;
        AlgebraicSurface rough = surface("z^3 - 3*(" + c + ")*z^2 + 3*(" + c + ")^2*z - (" + c + ")^3");
        for (const double half : {0x1p-8, 0x1p-10, 0x1p-13}) {
            rough.box << -0x1p-10, -0x1p-10, h - half, 0x1p-10, 0x1p-10, h + half;
            Query query;
            query.tolerance = {Tolerance::Of::absolute, 1e-9};
            query.budget = 4;
            Trace trace;
            const Result result = session_of("surface_enclosure", rough, plane).solve(query, trace);
            EXPECT_LE(result.bounds.lower, h) << h << ", " << half;
            EXPECT_GE(result.bounds.lower, h - 2 * half) << h << ", " << half;
            EXPECT_GE(result.bounds.upper, h) << h << ", " << half;
        }
    }
}

// If the distance is constant or has a curve of maxima, boxes need not be as small as the square root of the tolerance.
TEST(SurfaceSolvers, FewBoxesWhereTheDistanceIsConstant) {
    const auto s = [](const std::string& text) { return surface(text); };
    const AlgebraicSurface ball = s("x^2 + y^2 + z^2 - 1"), large = s("x^2 + y^2 + z^2 - 9/4"),
                           tube = s("x^2 + y^2 - 1"), wide = s("x^2 + y^2 - 9/4"),
                           torus = s("(x^2 + y^2 + z^2 + 3/4)^2 - 4*(x^2 + y^2)"),
                           thin = s("(x^2 + y^2 + z^2 + 15/16)^2 - 4*(x^2 + y^2)");
    struct Constant {
        AlgebraicSurface a, b;
        double h;
        std::uint64_t splits;
    };
    const Constant pairs[] = {
        {ball, large, 0.5, 1500},  {large, ball, 0.5, 1700}, {ball, s("(x - 1/4)^2 + y^2 + z^2 - 1"), 0.25, 300},
        {tube, wide, 0.5, 1200},   {wide, tube, 0.5, 800},   {tube, s("(x - 1/4)^2 + y^2 - 1"), 0.25, 2200},
        {torus, thin, 0.25, 7000}, {torus, ball, 0.5, 5500}, {ball, s("2*x^2 + 2*y^2 + 2*z^2 - 2"), 0, 1400},
    };
    for (const auto& [a, b, h, splits] : pairs) {
        Query query;
        query.tolerance = {Tolerance::Of::absolute, 1e-8};
        query.budget = splits;
        Trace trace;
        const Result result = session_of("surface_enclosure", a, b).solve(query, trace);
        const std::string where = a.polynomial + " to " + b.polynomial;
        EXPECT_LE(result.bounds.lower, h) << where;
        EXPECT_GE(result.bounds.upper, h) << where;
        EXPECT_EQ(to_string(result.status), "converged") << where << ", gap " << result.bounds.gap();
    }
}

// Both surfaces lie in the plane z = 0, but B ends at its box: zeros of its polynomial outside are not points of B.
TEST(SurfaceSolvers, ATargetThatItsBoxCutsOff) {
    AlgebraicSurface a = surface("z"), b = surface("z");
    a.box.row(0).setConstant(-1);
    a.box.row(1).setConstant(1);
    const std::pair<std::array<double, 4>, double> cuts[] = {
        // x range and y range of B's box, and h^2
        {{-0.6, 0.2, -0.5, 0.5}, 0.89},
        {{-0.6, 0.2, -0.75, 0.25}, 1.2025},
        {{-0.5, 0.5, -0.5, 0.5}, 0.5},
        {{-1, 0.6, -1, 1}, 0.16},
    };
    for (const auto& [cut, squared] : cuts) {
        b.box.row(0) = Eigen::RowVector3d(cut[0], cut[2], -1);
        b.box.row(1) = Eigen::RowVector3d(cut[1], cut[3], 1);
        Query query;
        query.tolerance = {Tolerance::Of::absolute, 1e-3};
        query.budget = 100000;
        Trace trace;
        const Result result = session_of("surface_enclosure", a, b).solve(query, trace);
        EXPECT_LE(result.bounds.lower, std::sqrt(squared) + 1e-12) << squared;
        EXPECT_GE(result.bounds.upper, std::sqrt(squared) - 1e-12) << squared;
        EXPECT_EQ(to_string(result.status), "converged") << squared << ", gap " << result.bounds.gap();
    }
}

TEST(SurfaceSolvers, AskedForMoreTheyGiveMore) {
    const Result fine = solve("surface_enclosure", cone_2, cone_1, 1e-10);
    EXPECT_EQ(to_string(fine.status), "converged");
    EXPECT_LE(fine.bounds.lower, true_h);
    EXPECT_GE(fine.bounds.upper, true_h);
    const Vec3 w = fine.witness.source_point.cwiseAbs();
    EXPECT_LT((w - Vec3(2, std::sqrt(7.0) / 3, 2)).norm(), 1e-4);
    EXPECT_NEAR((fine.witness.source_point - fine.witness.target_point).norm(), true_h, 1e-6);
}

TEST(MeshBridge, OverlapsWithTheEnclosure) {
    int narrow = 0;
    for (const Known& k : gallery()) {
        const Result bridge = solve("surface_meshes", k.a, k.b, 1e-3);
        const Result enclosed = solve("surface_enclosure", k.a, k.b, 0.01);
        EXPECT_LE(bridge.bounds.lower, k.h) << k.name;
        EXPECT_GE(bridge.bounds.upper, k.h) << k.name;
        EXPECT_LE(bridge.bounds.lower, enclosed.bounds.upper) << k.name;
        EXPECT_GE(bridge.bounds.upper, enclosed.bounds.lower) << k.name;
        narrow += bridge.bounds.gap() < 1;
        const auto number = [&](const char* name) { return std::get<double>(bridge.reported.at(name)); };
        const double wide = number("mesh_upper") - number("mesh_lower") + number("mesh_a_to_surface") +
                            number("surface_to_mesh_a") + number("mesh_b_to_surface") + number("surface_to_mesh_b");
        EXPECT_LE(bridge.bounds.gap(), wide * (1 + 1e-12)) << k.name;
        EXPECT_GE(number("triangles_a"), 100) << k.name;
        std::printf("%-34s [%.4f, %.4f], meshes [%.4f, %.4f], A %.1e and %.1e, B %.1e and %.1e\n", k.name.c_str(),
                    bridge.bounds.lower, bridge.bounds.upper, number("mesh_lower"), number("mesh_upper"),
                    number("mesh_a_to_surface"), number("surface_to_mesh_a"), number("mesh_b_to_surface"),
                    number("surface_to_mesh_b"));
    }
    EXPECT_GE(narrow, 10);
}

TEST(MeshBridge, SaysWhyItStopsAndWhatItCannotTake) {
    const AlgebraicSurface ball = surface("x^2 + y^2 + z^2 - 1"), square = surface("(x^2 + y^2 + z^2 - 1)^2");
    const Result coarse =
        solve("surface_meshes", ball, surface("x^2 + y^2 + z^2 - 9/4"), 1e-3, {{"cells", std::int64_t(8)}});
    EXPECT_EQ(coarse.status, Status::stalled);
    EXPECT_NE(coarse.note.find("cells"), std::string::npos) << coarse.note;
    // The square of a polynomial does not change sign, so no mesh is found. If A may be empty, the upper bound comes
    // from the boxes; if B may be, it is infinite.
    const Result from = solve("surface_meshes", square, surface("x^2 + y^2 + z^2 - 9/4"), 1e-3);
    EXPECT_EQ(from.bounds.lower, 0);
    EXPECT_GE(from.bounds.upper, std::sqrt(48.0));
    EXPECT_LE(from.bounds.upper, std::sqrt(48.0) * (1 + 1e-12));
    const Result to = solve("surface_meshes", ball, square, 1e-3);
    EXPECT_EQ(to.bounds.lower, 0);
    EXPECT_EQ(to.bounds.upper, std::numeric_limits<double>::infinity());
    for (const Result& result : {from, to}) {
        EXPECT_EQ(result.status, Status::stalled);
        EXPECT_NE(result.note.find("one sign at all corners"), std::string::npos) << result.note;
    }
}

// The coarse mesh of the ball B lies inside B, so A, a tiny patch of a plane, is farther from the mesh than from B.
TEST(MeshBridge, TheMeshOfBMayBeFartherThanB) {
    const AlgebraicSurface ball = surface("(x - 1/8)^2 + (y - 1/5)^2 + (z - 1/6)^2 - 1");
    for (const auto& [x, y] : {std::pair{0.125, 0.25}, {0.375, 0.0}, {-0.25, 0.5}}) {
        AlgebraicSurface patch = surface("z - 3/2");
        patch.box << x - 0x1p-12, y - 0x1p-12, 1.25, x + 0x1p-12, y + 0x1p-12, 1.75;
        double h = 0;
        for (const double at_x : {patch.box(0, 0), patch.box(1, 0)})
            for (const double at_y : {patch.box(0, 1), patch.box(1, 1)})
                h = std::max(h, (Vec3(at_x, at_y, 1.5) - Vec3(0.125, 0.2, 1.0 / 6)).norm() - 1);
        const Result result = solve("surface_meshes", patch, ball, 1e-4, {{"cells", std::int64_t(8)}});
        EXPECT_LE(result.bounds.lower, h + 1e-12) << x << ", " << y;
        EXPECT_GE(result.bounds.upper, h - 1e-12) << x << ", " << y;
        EXPECT_GT(std::get<double>(result.reported.at("mesh_lower")), h) << x << ", " << y;
    }
}

// The farthest point of the ball A lies outside its mesh.
TEST(MeshBridge, AMayReachFartherThanItsMesh) {
    const AlgebraicSurface ball = surface("(x - 1/8)^2 + (y - 1/5)^2 + (z - 1/6)^2 - 1"),
                           plane = surface("z + 2 - 1/16");
    const double h = 1.0 + 1.0 / 6 + 2 - 1.0 / 16;
    const Result result = solve("surface_meshes", ball, plane, 1e-4, {{"cells", std::int64_t(8)}});
    EXPECT_LE(result.bounds.lower, h + 1e-12);
    EXPECT_GE(result.bounds.upper, h - 1e-12);
    EXPECT_LT(std::get<double>(result.reported.at("mesh_upper")), h);
}

TEST(MeshBridge, DeviatesByTheSquareOfACell) {
    const AlgebraicSurface ball = surface("x^2 + y^2 + z^2 - 1");
    double before = 0;
    for (const int cells : {8, 16, 32}) {
        const TriangleMesh mesh = triangulate(ball, cells);
        const MeshDeviation d = deviation(ball, mesh, cells);
        double truth = 0;  // distance of the mesh's vertices and centroids, which lie inside
        for (Index t = 0; t < mesh.triangles.rows(); ++t) {
            Vec3 middle = Vec3::Zero();
            for (int k = 0; k < 3; ++k) middle += mesh.vertices.row(mesh.triangles(t, k)).transpose() / 3;
            truth = std::max(truth, std::abs(1 - middle.norm()));
        }
        EXPECT_GE(d.mesh_to_surface, truth);
        EXPECT_GE(d.surface_to_mesh, truth / 2);
        EXPECT_LT(d.surface_to_mesh, 4.0 / cells);
        if (before > 0) {
            EXPECT_LT(d.mesh_to_surface, 0.5 * before);
        }
        before = d.mesh_to_surface;
    }
    EXPECT_LT(before, 0.02);
    EXPECT_THROW(triangulate(surface("(x^2 + y^2 + z^2 - 1)^2"), 16), InputError);
}

TEST(SurfaceSolvers, WithoutChangeOfSignTheyStallAndHold) {
    const AlgebraicSurface twice = surface("(x^2 + y^2 + z^2 - 1)^2"), ball = surface("x^2 + y^2 + z^2 - 9/4");
    for (const auto& [a, b] : {std::pair{twice, ball}, {ball, twice}, {twice, twice}}) {
        const Result result = solve("surface_enclosure", a, b, 1e-3);
        const double h = &a == &b || (a.polynomial == b.polynomial) ? 0 : 0.5;
        EXPECT_EQ(to_string(result.status), "stalled");
        EXPECT_LE(result.bounds.lower, h);
        EXPECT_GE(result.bounds.upper, h);
        EXPECT_NE(result.note.find("sign"), std::string::npos) << result.note;
    }
}

// All boxes are dropped because B passes through them. A must be proven to have a point all the same.
TEST(SurfaceSolvers, SurfacesThatCoincide) {
    const std::pair<const char*, const char*> pairs[] = {{"z", "z"},
                                                         {"x", "x"},
                                                         {"x + y", "x + y"},
                                                         {"z", "-2*z"},
                                                         {"x - 1/2", "x - 1/2"},
                                                         {"x + 2*y - z", "x + 2*y - z"},
                                                         {"z", "z^3 + z"}};
    for (const auto& [a, b] : pairs) {
        const Result result = solve("surface_enclosure", surface(a), surface(b), 1e-9);
        EXPECT_EQ(to_string(result.status), "converged") << a << ": " << result.note;
        EXPECT_EQ(result.bounds.lower, 0) << a;
        EXPECT_LE(result.bounds.upper, 1e-9) << a;
        EXPECT_TRUE(result.witness.source_point.allFinite()) << a;
    }
}

TEST(SurfaceSolvers, RefuseWhatIsEmpty) {
    const AlgebraicSurface empty = surface("x^2 + y^2 + z^2 + 1"), outside = surface("x - 3"),
                           ball = surface("x^2 + y^2 + z^2 - 1");
    for (const char* solver : {"interval_subdivision", "surface_enclosure"}) {
        for (const AlgebraicSurface& none : {empty, outside}) {
            for (const bool source : {true, false}) {
                try {
                    session_of(solver, source ? none : ball, source ? ball : none);
                    FAIL() << solver;
                } catch (const InputError& error) {
                    EXPECT_NE(std::string(error.what()).find("no point in its box"), std::string::npos) << error.what();
                }
            }
        }
    }
}

TEST(SurfaceSolvers, KeepTheContract) {
    for (const SolverEntry& entry : solvers()) {
        if (!entry.info.source.surface) continue;
        ParameterMap quick;
        if (entry.info.name == "interval_subdivision") quick = {{"depth", std::int64_t(4)}};
        if (entry.info.name == "surface_meshes") quick = {{"cells", std::int64_t(24)}};
        for (const Known& k : gallery()) {
            if (k.tolerance < 1e-6) continue;
            const Session session(entry, Options(entry.info.name, entry.info.parameters, quick), {k.a, k.b}, {});
            const std::string where = entry.info.name + " on " + k.name;
            const auto ask = [&](auto&& change) {
                Query query;
                query.tolerance = {Tolerance::Of::absolute, 0.05};
                change(query);
                Trace trace(Trace::Mode::on);
                const Result result = session.solve(query, trace);
                EXPECT_LE(result.bounds.lower, result.bounds.upper) << where;
                if (entry.info.certified) {
                    EXPECT_LE(result.bounds.lower, k.h + 1e-15) << where;
                    EXPECT_GE(result.bounds.upper, k.h * (1 - 1e-15)) << where;
                    for (const TraceSample& s : trace.samples())
                        EXPECT_TRUE(s.lower <= k.h + 1e-15 && s.upper >= k.h * (1 - 1e-15)) << where;
                }
                EXPECT_FALSE(trace.samples().empty()) << where;
                const bool close = result.bounds.gap() <= query.tolerance.gap(result.bounds.lower);
                EXPECT_EQ(result.status == Status::converged, close) << where;
                return result;
            };
            const Result first = ask([](Query&) {}), again = ask([](Query&) {});
            EXPECT_EQ(first.bounds.lower, again.bounds.lower) << where;
            EXPECT_EQ(first.bounds.upper, again.bounds.upper) << where;
            EXPECT_EQ(first.counters, again.counters) << where;
            for (const std::uint64_t budget : {0, 1, 20}) ask([&](Query& q) { q.budget = budget; });
            ask([](Query& q) { q.time_limit = 0; });
            if (!entry.info.certified || entry.info.name == "surface_meshes") continue;  // the mesh limits its gap
            if (k.h > 0.1) {
                EXPECT_GT(ask([&](Query& q) {
                              q.cutoff = 0.5 * k.h;
                              q.tolerance.value = 1e-6;
                          }).bounds.lower,
                          0.5 * k.h)
                    << where;
                EXPECT_LE(ask([&](Query& q) {
                              q.cutoff = 1.5 * k.h;
                              q.tolerance.value = 1e-6;
                          }).bounds.upper,
                          1.5 * k.h)
                    << where;
            }
        }
    }
}

// Two spheres, one inside the other: the distance is 0.5 in both directions.
Result solve_spheres(const Session& session, Quantity quantity) {
    Query query;
    query.quantity = quantity;
    query.tolerance = {Tolerance::Of::absolute, 0.05};
    query.budget = 20000;
    Trace trace;
    return session.solve(query, trace);
}

template <class F> void for_each_surface_solver(F&& f) {
    const Scene scene{surface("x^2 + y^2 + z^2 - 1"), surface("x^2 + y^2 + z^2 - 9/4")};
    int tried = 0;
    for (const SolverEntry& entry : solvers()) {
        if (!entry.info.source.surface || entry.info.name == "external") continue;
        ParameterMap given;
        if (entry.info.name == "interval_subdivision") given = {{"depth", std::int64_t(4)}};
        f(entry, Session(entry, Options(entry.info.name, entry.info.parameters, given), scene, {.symmetric = true}));
        ++tried;
    }
    EXPECT_GE(tried, 3);
}

void expect_same_bits(const Result& a, const Result& b, const std::string& where) {
    EXPECT_EQ(a.status, b.status) << where;
    EXPECT_EQ(a.bounds.lower, b.bounds.lower) << where;
    EXPECT_EQ(a.bounds.upper, b.bounds.upper) << where;
    EXPECT_EQ(a.counters, b.counters) << where;
}

TEST(SurfaceSolvers, BothDirectionsMakeH) {
    for_each_surface_solver([](const SolverEntry& entry, const Session& session) {
        const Result directed = solve_spheres(session, Quantity::directed),
                     both = solve_spheres(session, Quantity::symmetric);
        EXPECT_LE(both.bounds.lower, 0.5) << entry.info.name;
        EXPECT_GE(both.bounds.upper, 0.5) << entry.info.name;
        EXPECT_GE(both.bounds.lower, directed.bounds.lower) << entry.info.name;
        EXPECT_GE(both.bounds.upper, directed.bounds.upper) << entry.info.name;
        EXPECT_GE(both.counters.polynomial_evaluations, directed.counters.polynomial_evaluations) << entry.info.name;
    });
}

// The result must not depend on a rounding mode that prepare() set in another thread.
TEST(SurfaceSolvers, AFreshThreadGivesTheSameBits) {
    for_each_surface_solver([](const SolverEntry& entry, const Session& session) {
        const Result here = solve_spheres(session, Quantity::symmetric);
        Result there;
        int mode = -1;
        std::thread([&] {
            there = solve_spheres(session, Quantity::symmetric);
            mode = std::fegetround();
        }).join();
        expect_same_bits(here, there, entry.info.name);
        EXPECT_EQ(mode, FE_TONEAREST) << entry.info.name;
    });
}

// surface_enclosure must set the rounding mode that it needs, and restore the caller's. On surfaces whose coefficients are
// no doubles, so that the steps of the search are rounded.
TEST(SurfaceSolvers, TheEnclosureSetsItsRoundingItself) {
    const Session session = session_of("surface_enclosure", surface("(x - 1/3)^2/7 + y^2/3 + z^2/5 - 1/11"),
                                       surface("(x - 1/3)^2/7 + y^2/3 + z^2/5 - 2/11"));
    const Result here = solve_spheres(session, Quantity::directed);
    Result there;
    int mode = -1;
    std::thread([&] {
        std::fesetround(FE_DOWNWARD);
        there = solve_spheres(session, Quantity::directed);
        mode = std::fegetround();
    }).join();
    EXPECT_LT(here.bounds.lower, here.bounds.upper);
    expect_same_bits(here, there, "surface_enclosure");
    EXPECT_EQ(mode, FE_DOWNWARD);
}

TEST(Session, SurfacesStandStillAndStayUnscaled) {
    const Session session = session_of("surface_enclosure", cone_1, cone_2);
    Query query;
    query.tolerance = {Tolerance::Of::absolute, 0.1};
    query.source_pose.translation = Vec3(1, 0, 0);
    Trace trace;
    EXPECT_THROW((void)session.solve(query, trace), InputError);
    const SolverEntry& naive = find_solver("naive");
    EXPECT_THROW(Session(naive, Options("naive", {}, {}), {cone_1, cone_2}, {}), InputError);
    const AlgebraicSurface wide = surface("z", 300), other = surface("z - 100", 300);
    EXPECT_NEAR(solve("surface_enclosure", wide, other, 1e-6).bounds.upper, 100, 1e-6);
}

}  // namespace
}  // namespace hausbench
