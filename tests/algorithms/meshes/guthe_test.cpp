// The parameters of guthe: without certification little changes; with the textbook kernel, bounds go wrong.
#include "algorithms/kernel/closest.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/exact_points.h"
#include "tests/support/reference.h"
#include "tests/support/scenes.h"
#include "tests/support/triangle_samples.h"

#include <functional>
#include <tuple>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

Result solve(const Scene& scene, double tolerance, const ParameterMap& given) {
    const SolverEntry& guthe = find_solver("guthe");
    const Session session(guthe, Options("guthe", guthe.info.parameters, given), scene, {});
    Query query;
    query.tolerance = {Tolerance::Of::absolute, tolerance};
    Trace trace;
    return session.solve(query, trace);
}

TEST(Guthe, IsCertifiedOnlyWhereItAccountsForRounding) {
    const SolverEntry& guthe = find_solver("guthe");
    const auto certified = [&](const ParameterMap& given) {
        return guthe.make(Options("guthe", guthe.info.parameters, given))->certified();
    };
    EXPECT_TRUE(certified({}));
    EXPECT_FALSE(certified({{"certify", false}}));
    EXPECT_FALSE(certified({{"kernel", "textbook"}}));
}

TEST(Guthe, CertificationChangesBoundsByRoundingOnly) {
    Random random(1);
    for (int i = 0; i < 20; ++i) {
        const Scene scene{soup(cloud(random, 30)), soup(cloud(random, 3 * (5 + 10 * i)))};
        const Result with = solve(scene, 1e-6, {}), without = solve(scene, 1e-6, {{"certify", false}});
        EXPECT_EQ(to_string(with.status), "converged");
        EXPECT_NEAR(with.bounds.lower, without.bounds.lower, 1e-6);
        EXPECT_NEAR(with.bounds.upper, without.bounds.upper, 1e-6);
        EXPECT_GE(with.bounds.upper, without.bounds.lower);
        EXPECT_LE(with.bounds.lower, without.bounds.upper);
    }
}

// If the tolerance is below the precision of doubles, the status must say so, and the bounds must be as tight as
// rounding allows.
TEST(Guthe, AToleranceBelowRoundingIsThePrecisionFloor) {
    Random random(4);
    for (const double offset : {0.0, 1e8}) {
        const Vec3 far(offset, -offset, offset);
        const auto moved = [&](TriangleMesh mesh) {
            mesh.vertices.rowwise() += far.transpose();
            return mesh;
        };
        for (int i = 0; i < 10; ++i) {
            const Scene scene{moved(soup(cloud(random, 12))), moved(soup(cloud(random, 3 * (2 + 10 * i))))};
            const auto& source = mesh_of(scene.source);
            const double unit =
                unit_roundoff * std::max(magnitude(source.vertices), magnitude(points_of(scene.target)));
            const Result result = solve(scene, 1e-3 * unit, {});
            EXPECT_EQ(to_string(result.status), "precision_floor") << i;
            EXPECT_GT(result.bounds.gap(), 1e-3 * unit);
            EXPECT_LT(result.bounds.gap(), 400 * unit) << "the floor is higher than rounding";
            const auto [low, high] =
                MeshReference(mesh_of(scene.target)).hausdorff(source.vertices, source.triangles, 1e-7L);
            EXPECT_LE(result.bounds.lower, high);
            EXPECT_GE(result.bounds.upper, low);
        }
        const Scene same{moved(soup(cloud(random, 90))), moved(soup(cloud(random, 90)))};
        const Scene identical{same.source, same.source};
        EXPECT_EQ(to_string(solve(identical, 1e-20, {}).status), "precision_floor");
        EXPECT_EQ(to_string(solve(identical, 1e-9 * std::max(1.0, offset), {}).status), "converged");
    }
}

// B is a triangle whose corners are collinear up to rounding. For one point in 250, the textbook's nearest point is
// wrong by the size of the triangle.
Scene rounded_collinear(Random& random) {
    const Triangle t = thin(random, 0, random.real(0.1, 0.9));
    return {soup(cloud(random, 90)), soup(rows({t.a, t.b, t.c}))};
}

// A far triangle in B, one in both meshes, or A far from B: the work must stay within four times the work at an
// ordinary distance.
TEST(Guthe, WorkDoesNotGrowWithTheRatioOfScales) {
    const TriangleMesh a = sheet(16, 0.05, 0.2), b = sheet(24, 0, 0.1);
    const auto with_stray = [](TriangleMesh mesh, const Vec3& away) {
        const Index vertices = static_cast<Index>(mesh.vertices.rows()),
                    triangles = static_cast<Index>(mesh.triangles.rows());
        mesh.vertices.conservativeResize(vertices + 3, 3);
        mesh.triangles.conservativeResize(triangles + 1, 3);
        for (int k = 0; k < 3; ++k) {
            mesh.vertices.row(vertices + k) = away + Vec3::Unit(k);
            mesh.triangles(triangles, k) = vertices + k;
        }
        return mesh;
    };
    const auto moved = [](TriangleMesh mesh, const Vec3& away) {
        mesh.vertices.rowwise() += away.transpose();
        return mesh;
    };
    const std::vector<std::function<Scene(const Vec3&)>> kinds{
        [&](const Vec3& away) {
            return Scene{a, with_stray(b, away)};
        },
        [&](const Vec3& away) {
            return Scene{with_stray(a, away), with_stray(b, away)};
        },
        [&](const Vec3& away) {
            return Scene{moved(a, away), b};
        }};
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
        const auto work = [&](double ratio) { return solve(kinds[kind](ratio * Vec3(3, 2, 2.5)), 1e-4, {}).counters; };
        const Counters tame = work(1);
        for (const double ratio : {1e3, 1e6, 1e9, 1e12}) {
            const Counters counters = work(ratio);
            EXPECT_LE(counters.node_visits, 4 * tame.node_visits) << kind << " " << ratio;
            EXPECT_LE(counters.point_triangle_distances, 4 * tame.point_triangle_distances) << kind << " " << ratio;
        }
    }
}

TEST(Guthe, TheTextbookKernelGoesWrong) {
    Random random(2);
    int wrong = 0;
    for (int i = 0; i < 500; ++i) {
        const Scene scene = rounded_collinear(random);
        const auto& source = mesh_of(scene.source);
        const auto [low, high] =
            MeshReference(mesh_of(scene.target)).hausdorff(source.vertices, source.triangles, 1e-6L);
        const Result robust = solve(scene, 1e-6, {});
        EXPECT_LE(robust.bounds.lower, high);
        EXPECT_GE(robust.bounds.upper, low);
        const Result textbook = solve(scene, 1e-6, {{"kernel", std::string("textbook")}, {"certify", false}});
        if (textbook.bounds.lower > high + 1e-5L || textbook.bounds.upper < low - 1e-5L) ++wrong;
    }
    EXPECT_GT(wrong, 0) << "the scene does not show what it is for";
    std::cout << wrong << " of 500 intervals of the textbook kernel miss the distance\n";
}

TEST(Guthe, TheTextbookKernelAgreesOnTameMeshes) {
    Random random(3);
    for (const Index triangles : {10, 200}) {
        const Scene scene{soup(cloud(random, 30)), soup(cloud(random, 3 * triangles))};
        const Result robust = solve(scene, 1e-6, {}),
                     textbook = solve(scene, 1e-6, {{"kernel", std::string("textbook")}});
        EXPECT_NEAR(robust.bounds.lower, textbook.bounds.lower, 1e-6);
        EXPECT_NEAR(robust.bounds.upper, textbook.bounds.upper, 1e-6);
    }
}

// --- bounds against the exact distance -------------------------------------------------------------------------------

using exact::Rational;

void expect_holds(const Result& result, const Rational& squared, const std::string& where) {
    const Rational lower = result.bounds.lower, upper = result.bounds.upper;
    EXPECT_TRUE(lower * lower <= squared) << where;
    EXPECT_TRUE(upper * upper >= squared) << where;
}

// The tolerance is below rounding, so the bounds are as tight as they are proven; they must still contain the exact
// distance.
TEST(Guthe, BoundsHoldExactlyAtThePrecisionFloor) {
    Random random(5);
    for (const char* split : {"midpoint", "longest_edge"}) {
        for (int i = 0; i < 400; ++i) {
            // Corners near 1, whose midpoints have the largest rounding error, or corners near the origin.
            const Vec3 offset = i % 2 == 0 ? Vec3::Ones() : Vec3::Zero();
            const double size = i % 2 == 0 ? 0.25 : 1;
            const auto any_point = [&] { return Vec3(offset + size * random.vector().cwiseAbs()); };
            const Triangle a{any_point(), any_point(), any_point()};
            std::vector<Vec3> b;
            for (int k = 0; k <= i % 3; ++k) b.push_back(any_point());
            const Scene scene{soup(rows({a.a, a.b, a.c})), points_as_triangles(b)};
            const Result result = solve(scene, 1e-30, {{"split", std::string(split)}});
            expect_holds(result, exact_squared(a, b), std::string(split) + ", scene " + std::to_string(i));
            EXPECT_LT(result.bounds.gap(), 1e-13) << i;
        }
    }
}

// The farthest point lies on an edge, about 45 halvings deep. So many roundings never all err in one direction, but the
// bounds must include the derived error.
TEST(Guthe, BoundsAreWidenedByTheLevelOfTheirPiece) {
    const Triangle a{{0, 0, 0}, {1, 0, 0}, {0.5, 0.01, 0}};
    const std::vector<Vec3> b{{0.1, -0.3, 0}, {0.8, -0.25, 0}};
    const Scene scene{soup(rows({a.a, a.b, a.c})), points_as_triangles(b)};
    const Rational squared = exact_squared(a, b), least = 40 * Rational(unit_roundoff);
    for (const char* split : {"midpoint", "longest_edge"}) {
        const Result result = solve(scene, 1e-30, {{"split", std::string(split)}});
        const Rational lower = result.bounds.lower + least,
                       upper = result.bounds.upper - Rational(100) * Rational(unit_roundoff);
        EXPECT_TRUE(lower * lower <= squared) << split;
        EXPECT_TRUE(upper * upper >= squared) << split;
    }
}

// B is one triangle, so the farthest point is a corner of A. The coordinates of one mesh are much smaller than the
// other's.
TEST(Guthe, BoundsHoldExactlyWhereOneMeshIsMuchSmaller) {
    Random random(6);
    for (int i = 0; i < 2000; ++i) {
        const double size_a = i % 2 == 0 ? 1e-12 : 1;
        const Triangle b{random.vector(), random.vector(), random.vector()};
        const Vec3 at = i % 2 == 0 ? inside(b, random) : Vec3::Zero();
        const Vec3 shift = i % 2 == 0 ? at : Vec3::Zero();
        const Triangle target{b.a - shift, b.b - shift, b.c - shift};
        const Triangle a{size_a * random.vector(), size_a * random.vector(), size_a * random.vector()};
        Rational squared = 0;
        for (const Vec3& v : {a.a, a.b, a.c}) {
            squared = std::max(squared,
                               exact::squared_distance_to_triangle(exact::vector(v), exact::vector(target.a),
                                                                   exact::vector(target.b), exact::vector(target.c)));
        }
        const Scene scene{soup(rows({a.a, a.b, a.c})), soup(rows({target.a, target.b, target.c}))};
        expect_holds(solve(scene, 1e-30, {}), squared, std::to_string(i));
    }
}

TEST(Guthe, BoundsHoldExactlyWhenThereIsNoTime) {
    Random random(7);
    const SolverEntry& guthe = find_solver("guthe");
    for (int i = 0; i < 200; ++i) {
        const Triangle a{random.vector(), random.vector(), random.vector()};
        const std::vector<Vec3> b{random.vector()};
        const Session session(guthe, Options("guthe", guthe.info.parameters, {}),
                              {soup(rows({a.a, a.b, a.c})), points_as_triangles(b)}, {});
        Query query;
        query.tolerance = {Tolerance::Of::absolute, 1e-30};
        query.time_limit = 1e-12;
        Trace trace;
        const Result result = session.solve(query, trace);
        EXPECT_EQ(to_string(result.status), "time_limit");
        expect_holds(result, exact_squared(a, b), std::to_string(i));
    }
}

// --- needles ---------------------------------------------------------------------------------------------------------

// The midpoint split keeps the shape of a thin triangle, so resolving its length takes the square of the necessary
// work.
TEST(Guthe, HalvingTheLongestEdgeResolvesANeedle) {
    const Triangle a{{0, 0, 0}, {1, 0, 0}, {0.4, 1e-6, 0}};
    const std::vector<Vec3> b{{0.1, 0.3, 0.2}, {0.8, 0.25, -0.1}};
    const Scene scene{soup(rows({a.a, a.b, a.c})), points_as_triangles(b)};
    const Result longest = solve(scene, 1e-8, {{"split", std::string("longest_edge")}});
    EXPECT_EQ(to_string(longest.status), "converged");
    EXPECT_LE(longest.counters.subdivisions, 5000u);
    expect_holds(longest, exact_squared(a, b), "needle");

    const SolverEntry& guthe = find_solver("guthe");
    const Session session(guthe, Options("guthe", guthe.info.parameters, {}), scene, {});
    Query query;
    query.tolerance = {Tolerance::Of::absolute, 1e-8};
    query.budget = 20000;
    Trace trace;
    const Result midpoint = session.solve(query, trace);
    EXPECT_EQ(to_string(midpoint.status), "budget") << "the published split is the default";
    expect_holds(midpoint, exact_squared(a, b), "needle");
}

TEST(Guthe, BothSplitsAgreeOnTameMeshes) {
    Random random(8);
    for (int i = 0; i < 10; ++i) {
        const Scene scene{soup(cloud(random, 60)), soup(cloud(random, 300))};
        const Result midpoint = solve(scene, 1e-6, {}),
                     longest = solve(scene, 1e-6, {{"split", std::string("longest_edge")}});
        EXPECT_EQ(to_string(longest.status), "converged");
        EXPECT_NEAR(longest.bounds.lower, midpoint.bounds.lower, 1e-6);
        EXPECT_NE(longest.counters, midpoint.counters);
    }
}

// --- warm starts -----------------------------------------------------------------------------------------------------

// Returns a torus or a lump with ears: a closed surface of 2 n^2 triangles and size about 1.
TriangleMesh closed_surface(Index n, const std::function<Vec3(double, double)>& at) {
    TriangleMesh mesh{Points(n * n, 3), Triangles(2 * n * n, 3)};
    for (Index i = 0; i < n; ++i) {
        for (Index j = 0; j < n; ++j) {
            const auto vertex = [&](Index k, Index l) { return (k % n) * n + l % n; };
            mesh.vertices.row(vertex(i, j)) = at(2 * M_PI * i / n, 2 * M_PI * j / n);
            mesh.triangles.row(2 * vertex(i, j)) << vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1);
            mesh.triangles.row(2 * vertex(i, j) + 1) << vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1);
        }
    }
    return mesh;
}

TriangleMesh torus(Index n) {
    return closed_surface(n, [](double u, double v) {
        return Vec3((0.6 + 0.2 * std::cos(v)) * std::cos(u), (0.6 + 0.2 * std::cos(v)) * std::sin(u),
                    0.2 * std::sin(v));
    });
}

TriangleMesh lump(Index n) {
    return closed_surface(n, [](double u, double v) {
        const double ears = 1 + 0.3 * std::sin(3 * u) * std::sin(v) + 0.2 * std::cos(2 * u + v);
        return Vec3(0.5 * ears * std::sin(v / 2) * std::cos(u), 0.4 * ears * std::sin(v / 2) * std::sin(u),
                    0.6 * ears * std::cos(v / 2));
    });
}

void add(Counters& sum, const Counters& counters) {
    for (const CounterField& field : counter_fields) sum.*field.member += counters.*field.member;
}

// Checks that the witness lies on the moved A, as far from B as the lower bound says, and that both intervals overlap.
void expect_same_answer(const Result& warm, const Result& cold, const Scene& scene, const Query& query,
                        const std::string& where) {
    EXPECT_EQ(to_string(warm.status), "converged") << where;
    EXPECT_LE(warm.bounds.gap(), query.tolerance.value) << where;
    EXPECT_LE(warm.bounds.lower, cold.bounds.upper) << where;
    EXPECT_GE(warm.bounds.upper, cold.bounds.lower) << where;
    const auto& source = mesh_of(scene.source);
    const TriangleMesh a{posed(source.vertices, query.source_pose), source.triangles};
    Counters counters;
    const Vec3& point = warm.witness.source_point;
    EXPECT_LE(closest_by_scan(a, point, {}, counters).squared_distance, 1e-28) << where;
    EXPECT_LE(closest_point(point, triangle_of(a, warm.witness.source_element)).squared_distance, 1e-28) << where;
    const double far = certified_distance_by_scan(mesh_of(scene.target), point, counters);
    EXPECT_NEAR(warm.bounds.lower, far, 1e-14) << where;
}

TEST(Guthe, WarmPosesHaveTheAnswersOfColdOnesForLessWork) {
    const SolverEntry& guthe = find_solver("guthe");
    ASSERT_TRUE(guthe.info.can(Ability::warm));
    // Name, scene, `regions`, and the fraction of the cold work that warm starts may take; regions leave less to save.
    const std::tuple<const char*, Scene, bool, double> chains[] = {
        {"torus in a torus", {torus(24), torus(40)}, false, 0.95},
        {"lump in a lump", {lump(24), lump(40)}, false, 0.9},
        {"fine lump on a torus", {lump(50), torus(16)}, false, 0.6},
        {"torus in a torus, regions", {torus(24), torus(40)}, true, 0.97},
        {"fine lump on a torus, regions", {lump(50), torus(16)}, true, 0.9}};
    for (const auto& [name, scene, regions, share] : chains) {
        for (const int stride : {1, 7}) {  // 7: consecutive poses are not neighbours in space
            const Session session(guthe, Options("guthe", guthe.info.parameters, {{"regions", regions}}), scene,
                                  {.moves = true});
            const auto state = session.begin();
            Counters cold_work, warm_work;
            for (int step = 0; step < 20; ++step) {
                Query query;
                query.tolerance = {Tolerance::Of::absolute, 1e-3};
                const double angle = 5 * M_PI / 180 * (step * stride % 20);
                query.source_pose.rotation = Eigen::AngleAxisd(angle, Vec3(1, 2, 3).normalized()).toRotationMatrix();
                query.source_pose.translation = 0.1 * angle * Vec3::UnitX();
                Trace trace;
                const Result cold = session.solve(query, trace), warm = session.solve(query, state.get(), trace);
                expect_same_answer(warm, cold, scene, query, std::string(name) + ", pose " + std::to_string(step));
                EXPECT_TRUE(step > 0 || warm.counters == cold.counters) << name << ": there is nothing to begin with";
                add(cold_work, cold.counters);
                add(warm_work, warm.counters);
            }
            const auto less = [&, label = name, most = share](std::uint64_t Counters::*member) {
                EXPECT_LT(static_cast<double>(warm_work.*member), most * static_cast<double>(cold_work.*member))
                    << label << ", stride " << stride;
            };
            if (stride > 1) continue;
            less(&Counters::closest_point_queries);
            if (regions) continue;
            less(&Counters::node_visits);
            less(&Counters::point_triangle_distances);
        }
    }
}

// B is a point, so one distance to it bounds all of A, and after a warm start nothing is left to split.
TEST(Guthe, WarmBoundsHoldExactly) {
    Random random(9);
    const SolverEntry& guthe = find_solver("guthe");
    for (int i = 0; i < 400; ++i) {
        const Triangle a{random.vector(), random.vector(), random.vector()};
        const std::vector<Vec3> b{random.vector()};
        const Session session(guthe, Options("guthe", guthe.info.parameters, {}),
                              {soup(rows({a.a, a.b, a.c})), points_as_triangles(b)}, {.moves = true});
        const auto state = session.begin();
        for (int step = 0; step < 3; ++step) {
            Query query;
            query.tolerance = {Tolerance::Of::absolute, 1e-30};
            query.source_pose.rotation = Eigen::AngleAxisd(step, Vec3::UnitY()).toRotationMatrix();
            Trace trace;
            const Points points = posed(rows({a.a, a.b, a.c}), query.source_pose);
            const Rational squared = exact_squared({points.row(0), points.row(1), points.row(2)}, b);
            expect_holds(session.solve(query, state.get(), trace), squared, std::to_string(i));
            query.time_limit = 1e-12;
            expect_holds(session.solve(query, state.get(), trace), squared, std::to_string(i) + ", no time");
        }
    }
}

// The farthest point lies inside a triangle of A. After a move it is known to within 7 * u * M, which the lower bound
// must include.
TEST(Guthe, AWarmWitnessIsWidenedByHowFarItMayBeFromTheSource) {
    const TriangleMesh source = soup(rows({{0, 0, 0}, {1, 0, 0}, {0.5, 0.9, 0.1}}));
    const TriangleMesh target = points_as_triangles({{0.1, -0.3, 0}, {0.9, -0.25, 0}, {0.5, 1.1, 0.2}});
    const SolverEntry& guthe = find_solver("guthe");
    const Session session(guthe, Options("guthe", guthe.info.parameters, {}), {source, target}, {.moves = true});
    const auto state = session.begin();
    Query query;
    query.tolerance = {Tolerance::Of::absolute, 1e-9};
    Trace trace;
    const Result before = session.solve(query, state.get(), trace);
    query.source_pose.translation = Vec3(0.001, -0.001, 0.002);
    query.budget = 0;
    const Result cold = session.solve(query, trace), warm = session.solve(query, state.get(), trace);
    EXPECT_NEAR(warm.bounds.lower, before.bounds.lower, 0.01);
    EXPECT_LT(cold.bounds.lower, warm.bounds.lower - 0.01) << "the farthest point is no corner";
    Counters counters;
    const double far = certified_distance_by_scan(target, warm.witness.source_point, counters);
    EXPECT_LE(warm.bounds.lower, far - 7 * unit_roundoff * 1.1);
    EXPECT_GE(warm.bounds.lower, far - 1e-14);
}

}  // namespace
}  // namespace hausbench
