// The values that guthe reports, on request, for each triangle of A and for its stages.
#include "algorithms/kernel/rounding.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/exact_points.h"
#include "tests/support/reference.h"
#include "tests/support/scenes.h"

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using exact::Rational;

Session session_of(const Scene& scene, const char* split = "midpoint", const QuerySet& queries = {},
                   bool certify = true) {
    const SolverEntry& guthe = find_solver("guthe");
    return {guthe, Options("guthe", guthe.info.parameters, {{"split", std::string(split)}, {"certify", certify}}),
            scene, queries};
}

Query asking(double tolerance) {
    Query query;
    query.tolerance = {Tolerance::Of::absolute, tolerance};
    query.wanted.fields = true;
    return query;
}

Result solve(const Session& session, const Query& query, State* state = nullptr) {
    Trace trace;
    return session.solve(query, state, trace);
}

const std::vector<double>& values(const Result& result, const std::string& name) {
    for (const Field& field : result.fields.value()) {
        if (field.name == name) return field.values;
    }
    throw std::out_of_range(name);
}

double largest(const std::vector<double>& numbers) { return *std::max_element(numbers.begin(), numbers.end()); }

// Checks that each triangle has bounds and that they agree with the bounds of the answer.
void expect_consistent(const Result& result, Index triangles, const std::string& where) {
    ASSERT_TRUE(result.fields) << where;
    ASSERT_EQ(result.fields->size(), 3u) << where;
    for (const char* name : {"lower", "upper", "level"})
        ASSERT_EQ(values(result, name).size(), static_cast<std::size_t>(triangles)) << where << ", " << name;
    EXPECT_EQ(largest(values(result, "upper")), result.bounds.upper) << where;
    // The fields include the lower bound of the witness's triangle; rounding may leave a larger one for another
    // triangle.
    EXPECT_GE(largest(values(result, "lower")), result.bounds.lower) << where;
    EXPECT_LE(largest(values(result, "lower")), result.bounds.upper) << where;
    for (const Field& field : *result.fields) {
        EXPECT_EQ(field.of, Field::Of::elements);
        EXPECT_EQ(field.meaning, field.name == "lower"   ? Field::Meaning::lower
                                 : field.name == "upper" ? Field::Meaning::upper
                                                         : Field::Meaning::number);
    }
}

// Checks the bounds of each triangle of `a`, moved by its pose, against its exact distance from the points `b`.
void expect_holds_exactly(const Result& result, const TriangleMesh& a, const std::vector<Vec3>& b,
                          const std::string& where) {
    expect_consistent(result, a.triangles.rows(), where);
    for (Index i = 0; i < a.triangles.rows(); ++i) {
        const Rational squared = exact_squared(triangle_of(a, i), b);
        const Rational lower = values(result, "lower").at(static_cast<std::size_t>(i)),
                       upper = values(result, "upper").at(static_cast<std::size_t>(i));
        EXPECT_TRUE(lower * lower <= squared) << where << ", triangle " << i;
        EXPECT_TRUE(upper * upper >= squared) << where << ", triangle " << i;
    }
}

// Checks the bounds of each triangle of `a`, moved by its pose, against the slow reference.
void expect_holds(const Result& result, const TriangleMesh& a, const TriangleMesh& b, const std::string& where) {
    expect_consistent(result, a.triangles.rows(), where);
    const MeshReference reference(b);
    const long double extent = std::max(magnitude(a.vertices), magnitude(b.vertices));
    for (Index i = 0; i < a.triangles.rows(); ++i) {
        const auto [low, high] = reference.hausdorff(a.vertices, a.triangles.row(i), 1e-4L * extent);
        EXPECT_LE(values(result, "lower").at(static_cast<std::size_t>(i)), high) << where << ", triangle " << i;
        EXPECT_GE(values(result, "upper").at(static_cast<std::size_t>(i)), low * (1 - 1e-17L))
            << where << ", triangle " << i;
    }
}

TriangleMesh mesh_at(const SharedShape& shape, const Pose& pose) {
    const auto triangles = [&]() -> Triangles {
        if (kind_of(shape) == ShapeKind::mesh) return mesh_of(shape).triangles;
        Triangles each(points_of(shape).rows(), 3);
        for (Index i = 0; i < each.rows(); ++i) each.row(i).setConstant(i);
        return each;
    };
    return {posed(points_of(shape), pose), triangles()};
}

// Returns triangles that share their first corner.
TriangleMesh fan(Random& random, Index triangles) {
    TriangleMesh mesh{cloud(random, triangles + 2), Triangles(triangles, 3)};
    mesh.vertices = (mesh.vertices.array() * 0.25 + 0.75).matrix().eval();
    for (Index i = 0; i < triangles; ++i) mesh.triangles.row(i) << i + 1, 0, i + 2;
    return mesh;
}

std::vector<Vec3> few_points(Random& random, int count) {
    std::vector<Vec3> points;
    for (int i = 0; i < count; ++i) points.push_back(Vec3(Vec3::Constant(0.75) + 0.25 * random.vector()));
    return points;
}

TEST(GutheFields, AreThereOnlyWhereTheyAreWantedAndChangeNothingElse) {
    EXPECT_TRUE(find_solver("guthe").info.can(Ability::fields));
    for (const TestScene& test : mesh_scenes()) {
        const Session session = session_of(test.scene);
        const double size = std::max(magnitude(points_of(test.scene.source)), magnitude(points_of(test.scene.target)));
        Query query = asking(std::max(1e-3 * size, 1e-300));
        const Result with = solve(session, query);
        query.wanted.fields = false;
        const Result without = solve(session, query);
        EXPECT_TRUE(with.fields) << test.name;
        EXPECT_FALSE(without.fields) << test.name;
        EXPECT_EQ(with.counters, without.counters) << test.name;
        EXPECT_EQ(with.bounds.lower, without.bounds.lower) << test.name;
        EXPECT_EQ(with.bounds.upper, without.bounds.upper) << test.name;
        EXPECT_EQ(with.status, without.status) << test.name;
        EXPECT_TRUE(with.reported.empty() && without.reported.empty()) << test.name;
    }
}

TEST(GutheFields, BoundsOfEachTriangleHoldExactly) {
    Random random(1);
    for (const char* split : {"midpoint", "longest_edge"}) {
        for (int i = 0; i < 150; ++i) {
            const TriangleMesh a = fan(random, 1 + i % 4);
            const std::vector<Vec3> b = few_points(random, 1 + i % 3);
            const Session session = session_of({a, points_as_triangles(b)}, split);
            for (const std::uint64_t budget : {0, 5, 100000}) {
                Query query = asking(1e-30);
                query.budget = budget;
                const Result result = solve(session, query);
                expect_holds_exactly(result, a, b, std::string(split) + ", scene " + std::to_string(i));
                // The corners of each triangle must have been measured.
                for (Index t = 0; t < a.triangles.rows(); ++t) {
                    for (const Index v : a.triangles.row(t)) {
                        Rational least = 100;
                        for (const Vec3& y : b)
                            least = std::min(
                                least, exact::squared_distance(exact::vector(a.vertices.row(v)), exact::vector(y)));
                        EXPECT_GE(values(result, "lower")[static_cast<std::size_t>(t)], exact::root(least) - 1e-14L);
                    }
                }
            }
        }
    }
}

TEST(GutheFields, BoundsHoldOnHostileMeshesAndOnPoints) {
    std::vector<TestScene> scenes = mesh_scenes();
    Random random(2);
    scenes.push_back(test_scene("points to a mesh", PointSet{cloud(random, 40)}, cube(0.5)));
    scenes.push_back(test_scene("a mesh to points", cube(0.5), PointSet{cloud(random, 40)}));
    scenes.push_back(test_scene("points to points", PointSet{cloud(random, 40)}, PointSet{cloud(random, 50)}));
    for (const TestScene& test : scenes) {
        const Session session = session_of(test.scene, "midpoint", {.moves = true});
        const double size = std::max(magnitude(points_of(test.scene.source)), magnitude(points_of(test.scene.target)));
        for (const Pose& pose : test.poses) {
            Query query = asking(std::max(1e-2 * size, 1e-300));
            query.source_pose = pose;
            expect_holds(solve(session, query), mesh_at(test.scene.source, pose), mesh_at(test.scene.target, Pose{}),
                         test.name);
        }
    }
}

// All points of A are equally far from B, so every triangle's bounds must meet.
TEST(GutheFields, BoundsOfParallelPlanesClose) {
    const TriangleMesh a = sheet(6, 0.25);
    const Result result = solve(session_of({a, sheet(6, 0)}), asking(1e-12));
    expect_consistent(result, a.triangles.rows(), "planes");
    for (std::size_t i = 0; i < static_cast<std::size_t>(a.triangles.rows()); ++i) {
        EXPECT_NEAR(values(result, "lower")[i], 0.25, 1e-14) << i;
        EXPECT_NEAR(values(result, "upper")[i], 0.25, 1e-14) << i;
        EXPECT_LE(values(result, "lower")[i], 0.25) << i;
        EXPECT_GE(values(result, "upper")[i], 0.25) << i;
    }
}

TEST(GutheFields, OnlyTrianglesThatWereSubdividedHaveALevel) {
    // The farthest point of the second triangle lies inside an edge, so this triangle must be subdivided.
    const TriangleMesh a =
        soup(rows({{0.1, -0.3, 0}, {0.1, -0.29, 0}, {0.11, -0.3, 0}, {0, 0, 0}, {1, 0, 0}, {0.5, 0.01, 0}}));
    const std::vector<Vec3> b{{0.1, -0.3, 0}, {0.8, -0.25, 0}};
    const Session session = session_of({a, points_as_triangles(b)});
    Query query = asking(1e-30);
    const Result result = solve(session, query);
    expect_holds_exactly(result, a, b, "edge");
    EXPECT_EQ(values(result, "level")[0], 0);
    EXPECT_GT(values(result, "level")[1], 20);
    EXPECT_LE(values(result, "level")[1], 50);
    query.budget = 1;
    EXPECT_EQ(values(solve(session, query), "level")[1], 1);
}

// From the second pose on, bounds of triangles come from earlier poses, without a query.
TEST(GutheFields, BoundsHoldExactlyAlongAWarmChain) {
    Random random(3);
    for (int i = 0; i < 100; ++i) {
        const TriangleMesh a = fan(random, 4);
        const std::vector<Vec3> b = few_points(random, 1 + i % 2);
        const Session session = session_of({a, points_as_triangles(b)}, "midpoint", {.moves = true});
        const auto state = session.begin();
        for (int step = 0; step < 3; ++step) {
            Query query = asking(1e-6);
            query.source_pose.translation = 0.01 * step * Vec3(1, 2, 3);
            const TriangleMesh there{posed(a.vertices, query.source_pose), a.triangles};
            expect_holds_exactly(solve(session, query, state.get()), there, b, std::to_string(i));
            query.time_limit = 1e-12;
            expect_holds_exactly(solve(session, query, state.get()), there, b, std::to_string(i) + ", no time");
        }
    }
}

TEST(GutheFields, BoundsHoldExactlyWhenThereIsNoTime) {
    Random random(4);
    for (int i = 0; i < 200; ++i) {
        const TriangleMesh a = fan(random, 3);
        const std::vector<Vec3> b = few_points(random, 1);
        Query query = asking(1e-30);
        query.time_limit = 1e-12;
        const Result result = solve(session_of({a, points_as_triangles(b)}), query);
        EXPECT_EQ(to_string(result.status), "time_limit");
        expect_holds_exactly(result, a, b, std::to_string(i));
    }
}

// Without certification, the bounds are the computed distances.
TEST(GutheFields, WithoutCertificationNothingIsWidened) {
    const TriangleMesh a = sheet(4, 0.25);
    const Result result = solve(session_of({a, sheet(4, 0)}, "midpoint", {}, false), asking(1e-12));
    for (std::size_t i = 0; i < static_cast<std::size_t>(a.triangles.rows()); ++i) {
        EXPECT_EQ(values(result, "lower")[i], 0.25) << i;
        EXPECT_EQ(values(result, "upper")[i], 0.25) << i;
    }
}

// For H(A,B), the fields must be the same as for h(A,B), whichever direction is larger.
TEST(GutheFields, OfBothDirectionsAreThoseOfTheSourceAndOfAMovedTarget) {
    const TriangleMesh small = sheet(4, 0.1, 0.2), large = sheet(6, 0, 0.3);
    Query query = asking(1e-2);
    query.source_pose = turned(0.6, 0.8, {0.25, 0, -0.5});
    query.target_pose = turned(0.8, 0.6, {0, 0.5, 0.25});
    QuerySet queries{.moves = true};
    queries.target_moves = queries.symmetric = true;
    const std::pair<Scene, Witness::Direction> cases[] = {{{small, large}, Witness::Direction::target_to_source},
                                                          {{large, small}, Witness::Direction::source_to_target}};
    for (const auto& [scene, direction] : cases) {
        const Session session = session_of(scene, "midpoint", queries);
        query.quantity = Quantity::directed;
        const Result directed = solve(session, query);
        query.quantity = Quantity::symmetric;
        const Result both = solve(session, query);
        EXPECT_EQ(both.witness.direction, direction);
        EXPECT_GE(both.bounds.upper, directed.bounds.upper);
        expect_holds(directed, mesh_at(scene.source, query.source_pose), mesh_at(scene.target, query.target_pose),
                     "posed");
        for (const char* name : {"lower", "upper", "level"})
            EXPECT_EQ(values(both, name), values(directed, name)) << name;
    }
}

TEST(GutheStages, AreReportedOnlyWhereTheyAreWanted) {
    const Session session = session_of({sheet(4, 0.1, 0.2), sheet(6, 0, 0.3)});
    const std::vector<std::string> all{"seconds: first bounds", "seconds: measure vertices", "seconds: subdivide"};
    for (const bool in_time : {true, false}) {
        Query query = asking(1e-3);
        query.wanted = {};
        if (!in_time) query.time_limit = 1e-12;
        EXPECT_TRUE(solve(session, query).reported.empty());
        query.wanted.stages = true;
        const Result result = solve(session, query);
        EXPECT_FALSE(result.fields);
        std::vector<std::string> names;
        for (const auto& [name, value] : result.reported) {
            names.push_back(name);
            EXPECT_GE(std::get<double>(value), 0) << name;
        }
        EXPECT_EQ(names, in_time ? all : std::vector<std::string>{"seconds: measure vertices"});
    }
}

}  // namespace
}  // namespace hausbench
