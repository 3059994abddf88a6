// The solver tang: its volumes, cuts and lists one by one, and its intervals with every option against a slow
// reference.
#include "algorithms/kernel/rounding.h"
#include "algorithms/meshes/tang/enclosed_move.h"
#include "algorithms/meshes/tang/near_walk.h"
#include "algorithms/meshes/tang/short_lists.h"
#include "algorithms/meshes/tang/volumes.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/exact_points.h"
#include "tests/support/scenes.h"
#include "tests/support/small_scenes.h"

#include <set>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using namespace tang;

using exact::Rational;
using exact::RVec3;
using exact::operator-;

constexpr double u = unit_roundoff;

Session session_for(const Scene& scene, const ParameterMap& given = {}, const QuerySet& queries = {}) {
    const SolverEntry& tang = find_solver("tang");
    return Session(tang, Options("tang", tang.info.parameters, given), scene, queries);
}

Result solve(const Scene& scene, const Query& query, const ParameterMap& given = {}) {
    const Session session = session_for(scene, given, {.moves = !query.source_pose.is_identity()});
    Trace trace;
    return session.solve(query, trace);
}

Query asking(double tolerance) {
    Query query;
    query.tolerance = {Tolerance::Of::absolute, tolerance};
    return query;
}

double reported(const Result& result, const std::string& name) { return std::get<double>(result.reported.at(name)); }

// The defaults, each option changed alone, and several together.
const std::vector<ParameterMap>& options() {
    const auto text = [](const char* value) { return std::string(value); };
    static const std::vector<ParameterMap> list{
        {},
        {{"volumes", text("boxes")}},
        {{"group", false}},
        {{"split", text("midpoint")}},
        {{"split", text("longest_edge")}},
        {{"least_part", 0.25}},
        {{"lemma4", true}},
        {{"volumes", text("boxes")}, {"group", false}, {"split", text("midpoint")}}};
    return list;
}

// --- volumes ---------------------------------------------------------------------------------------------------------

RVec3 mapped(const Pose& pose, const RVec3& p) {
    RVec3 result;
    for (std::size_t k = 0; k < 3; ++k) {
        result[k] = Rational(pose.translation[static_cast<int>(k)]);
        for (std::size_t j = 0; j < 3; ++j)
            result[k] += Rational(pose.rotation(static_cast<int>(k), static_cast<int>(j))) * p[j];
    }
    return result;
}

Pose any_pose(Random& random, int i) {
    Pose pose;
    if (i % 4 == 0) return pose;
    pose.rotation = Eigen::AngleAxisd(random.real(0, 6), random.vector().normalized()).toRotationMatrix();
    pose.translation = random.vector();
    if (i % 4 == 2) {
        for (int k = 0; k < 3; ++k) pose.rotation.row(k) = random.vector(3).transpose();  // any affine map
    }
    if (i % 4 == 3) pose.translation *= 1e6;
    return pose;
}

template <class Tree> void expect_volumes_to_hold(Random& random, int i) {
    TriangleMesh mesh = soup(cloud(random, 3 * (9 + i % 40), i % 5 == 0 ? 1e-3 : 1));
    if (i % 5 == 0) mesh.vertices.rowwise() += random.vector().transpose();
    if (i % 5 == 1) mesh.vertices.col(2).setZero();
    const Tree tree(mesh);
    const Pose pose = any_pose(random, i);
    const VolumePose moved(pose);
    const Points points = posed(mesh.vertices, pose);
    const Vec3 q = random.vector(2);
    for (std::size_t n = 0; n < tree.tree().nodes.size(); ++n) {
        const WideNode& node = tree.tree().nodes[n];
        for (int c = 0; c < node.count; ++c) {
            if (node.child[c] >= 0) continue;
            const double at_most = distance_at_most(moved(corners_of(tree, n, c)), q);
            const double at_least = distance_at_least(tree, n, c, q);
            for (const Index t : tree.tree().leaf(static_cast<std::size_t>(~node.child[c]))) {
                for (const Index v : mesh.triangles.row(t)) {
                    EXPECT_TRUE(Rational(at_most) * at_most >=
                                exact::squared_distance(exact::vector(points.row(v)), exact::vector(q)))
                        << i;
                    EXPECT_TRUE(Rational(at_least) * at_least <=
                                exact::squared_distance(exact::vector(mesh.vertices.row(v)), exact::vector(q)))
                        << i;
                }
            }
        }
    }
}

TEST(Volumes, HoldTheirContentInEveryPose) {
    Random random(1);
    for (int i = 0; i < 120; ++i) {
        expect_volumes_to_hold<SweptSphereBvh>(random, i);
        expect_volumes_to_hold<TriangleBvh>(random, i);
    }
}

// Moves a ball (a volume with one corner and a radius): the result must enclose the exact image.
TEST(Volumes, AMovedRadiusIsThatOfTheExactImage) {
    Random random(2);
    for (int i = 0; i < 2000; ++i) {
        Pose pose = any_pose(random, 1 + i % 3);
        if (i % 4 == 0) {  // so small or large that squares of its entries underflow or overflow
            const double scale = std::ldexp(1.0, static_cast<int>(random.below(1201)) - 600);
            pose.rotation *= scale, pose.translation *= scale;
        }
        CornerVolume volume;
        volume.count = 4;
        volume.corner.fill(random.vector());
        volume.radius = random.unit();
        const CornerVolume moved = VolumePose(pose)(volume);
        // A power iteration finds the direction that the pose stretches most.
        Vec3 d = random.vector();
        const Eigen::Matrix3d turn = pose.rotation / pose.rotation.cwiseAbs().maxCoeff();
        for (int k = 0; k < 40; ++k) d = (turn.transpose() * (turn * d)).normalized();
        const RVec3 c = exact::vector(volume.corner[0]);
        const Rational length = exact::squared_distance(exact::vector(d), RVec3{0, 0, 0});
        //d| is not exactly 1; this s keeps the point c + s * d within the ball.
        const Rational s = Rational(volume.radius) * (length <= 1 ? Rational(1) : Rational(1) / length);
        const Rational squared =
            exact::squared_distance(mapped(pose, exact::along(c, s, exact::vector(d))), exact::vector(moved.corner[0]));
        EXPECT_TRUE(Rational(moved.radius) * moved.radius >= squared) << i;
    }
}

// Bounds must include the derived rounding error, which no single example reaches.
TEST(Volumes, AreWidenedByWhatIsDerived) {
    const TriangleMesh mesh = soup(rows({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}));
    const SweptSphereBvh tree(mesh);
    EXPECT_GE(corners_of(tree, 0, 0).radius, 5 * u);
    EXPECT_LE(distance_at_least(TriangleBvh(mesh), 0, 0, Vec3::Zero()), std::sqrt(3.0) * (1 - 3 * u));
    CornerVolume volume;
    volume.count = 4;
    volume.corner.fill(Vec3::Ones());
    EXPECT_GE(distance_at_most(volume, Vec3::Zero()), std::sqrt(3.0) * (1 + 4 * u));
    Pose pose;
    pose.translation = {3, 0, 0};
    EXPECT_GE(VolumePose(pose)(volume).radius, 15 * u * 4);
    pose.rotation << 1, 0, 0, 0, 0, 2, 0, -2, 0;
    volume.radius = 1;
    EXPECT_GE(VolumePose(pose)(volume).radius, 2 * (1 + 8 * u) + 15 * u * (2 * 2 + 3));
    pose.translation = {1e308, 0, 0};
    pose.rotation *= 1e308;
    EXPECT_TRUE(std::isinf(VolumePose(pose)(volume).radius));
}

TEST(NearWalk, FindsAllLeavesWithinReach) {
    Random random(3);
    const TriangleMesh mesh = soup(cloud(random, 900, 1));
    const SweptSphereBvh tree(mesh);
    for (int i = 0; i < 50; ++i) {
        const Vec3 centre = random.vector();
        const double reach = random.real(0, 0.3);
        std::set<Index> visited;
        Counters counters;
        visit_near_leaves(tree, centre, reach, counters, [&](std::size_t leaf) {
            const std::array<Vec3, 3> points{centre, random.vector(), random.vector()};
            double squared[3][leaf_capacity];
            const unsigned mask = tree.leaf_distances(leaf, points, centre, reach * reach * (1 + 8 * u), squared);
            const auto triangles = tree.tree().leaf(leaf);
            for (std::size_t k = 0; k < triangles.size(); ++k) {
                if ((mask >> k & 1) == 0) continue;
                visited.insert(triangles[k]);
                for (std::size_t p = 0; p < 3; ++p)
                    EXPECT_EQ(squared[p][k],
                              closest_point(points[p], triangle_of(mesh, triangles[k])).squared_distance);
            }
        });
        for (Index t = 0; t < mesh.triangles.rows(); ++t) {
            const bool near = closest_point(centre, triangle_of(mesh, t)).squared_distance <= reach * reach;
            EXPECT_TRUE(!near || visited.contains(t));
        }
        EXPECT_LT(visited.size(), 300u);
    }
}

TEST(PointOfEdge, IsWithinItsLevelOfTheEdge) {
    Random random(4);
    for (int i = 0; i < 3000; ++i) {
        const Vec3 a = Vec3::Ones() - random.real(0, 0.3) * random.vector().cwiseAbs();
        const Vec3 b = i % 2 == 0 ? random.vector() : Vec3(a + random.vector() / 17);
        const double magnitude = std::max(a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff()), t = random.unit();
        const int level = level_of_point_of_edge((b - a).cwiseAbs().maxCoeff(), magnitude);
        const RVec3 exactly = exact::along(exact::vector(a), t, exact::vector(b) - exact::vector(a));
        const Rational most = 2 * level * Rational(u) * magnitude;
        EXPECT_TRUE(exact::squared_distance(exact::vector(point_of_edge(a, b, t)), exactly) <= most * most) << i;
    }
    EXPECT_EQ(level_of_point_of_edge(1.0 / 16, 1), 1);
    EXPECT_EQ(level_of_point_of_edge(0.07, 1), 5);
}

TEST(ShortLists, UseTheirRoomAgain) {
    ShortLists<8> lists;
    const std::vector<Index> some{1, 2, 3}, others{4, 5, 6, 7}, more{1, 2, 3, 4, 5};
    const auto first = lists.store(some), second = lists.store(more);
    EXPECT_EQ(std::vector<Index>(lists.numbers(first).begin(), lists.numbers(first).end()), some);
    lists.give_back(first);
    const auto third = lists.store(others);
    EXPECT_EQ(third.begin, first.begin);
    EXPECT_EQ(std::vector<Index>(lists.numbers(second).begin(), lists.numbers(second).end()), more);
    EXPECT_EQ(std::vector<Index>(lists.numbers(third).begin(), lists.numbers(third).end()), others);
    EXPECT_EQ(lists.store({}).count, 0u);
}

// --- Lemma 4 --------------------------------------------------------------------------------------------------------

double bound_by_move(const TriangleMesh& b, const Triangle& t, const Vec3& move, int level = 0) {
    const SweptSphereBvh tree(b);
    const Target target(b, &tree);
    Counters counters;
    return EnclosedMove<SweptSphereBvh>(tree, target, 2, counters).upper({t.a, t.b, t.c}, level, move);
}

TriangleMesh box(const Vec3& half) {
    TriangleMesh mesh = cube(1);
    for (int k = 0; k < 3; ++k) mesh.vertices.col(k) *= half[k];
    return mesh;
}

TEST(EnclosedMove, BoundsAPieceThatGoesIn) {
    const Triangle above{{-0.5, -0.5, 1.1}, {0.6, -0.4, 1.1}, {-0.3, 0.7, 1.1}};
    EXPECT_EQ(bound_by_move(cube(1), above, {0, 0, -0.125}), next_up(distance_at_most(0x1p-6, false) + 0x1p-500));
    EXPECT_TRUE(std::isinf(bound_by_move(cube(1), above, {0, 0, -0.05})));     // stays outside
    EXPECT_TRUE(std::isinf(bound_by_move(cube(1), above, {0.5, 0, -0.125})));  // T + D touches a side
    // A move out of B through the top counts too.
    const Triangle inside{{-0.5, -0.5, 0.9}, {0.6, -0.4, 0.9}, {-0.3, 0.7, 0.9}};
    EXPECT_LT(bound_by_move(cube(1), inside, {0, 0, 0.125}), 0.1251);
}

// Lemma 4 as printed would give 0.25, because the piece moved by D is enclosed. But part of the piece is inside from
// the start, more than 0.3 from the surface of B.
TEST(EnclosedMove, SaysNothingOfAPieceThatIsNotAllOutside) {
    const Triangle t{{-0.2, 0.1, 1.2}, {0.3, -0.2, 1.2}, {0.9, 0.1, 0.3}};
    const TriangleMesh b = cube(1);
    Counters counters;
    EXPECT_GT(Target(b, nullptr).closest(0.15 * t.a + 0.15 * t.b + 0.7 * t.c, -1, counters).squared_distance, 0.09);
    EXPECT_TRUE(std::isinf(bound_by_move(b, t, {0, 0, -0.25})));
}

// The move passes through a thin box and out again, far from one corner. In the second case it crosses the top at its
// diagonal, where either triangle may count as crossed.
TEST(EnclosedMove, SaysNothingWhereBIsCrossedTwice) {
    const TriangleMesh b = box({0.5, 0.5, 0.05});
    EXPECT_TRUE(std::isinf(bound_by_move(b, {{0, 0.1, 0.2}, {0.2, 0, 0.2}, {1.9, 0.1, 0.2}}, {0, 0, -0.5})));
    EXPECT_TRUE(std::isinf(bound_by_move(b, {{0, 0.4, 0.2}, {-0.3, 0.2, 0.2}, {1.9, 0.45, 0.2}}, {0.2, 0, -0.5})));
}

TEST(EnclosedMove, SaysNothingWithinRoundingOfB) {
    for (const int level : {0, 40}) {
        const double near = (level == 0 ? 6 : 200) * u, far = (level == 0 ? 2000 : 4000) * u;
        const auto above = [](double z) { return Triangle{{-0.5, -0.5, z}, {0.6, -0.4, z}, {-0.3, 0.7, z}}; };
        EXPECT_TRUE(std::isinf(bound_by_move(cube(1), above(1 + near), {0, 0, -0.125}, level))) << level;
        EXPECT_LT(bound_by_move(cube(1), above(1 + far), {0, 0, -0.125}, level), 0.126) << level;
        EXPECT_TRUE(std::isinf(bound_by_move(cube(1), above(1.125 - near), {0, 0, -0.125}, level))) << level;
        EXPECT_LT(bound_by_move(cube(1), above(1.125 - far), {0, 0, -0.125}, level), 0.126) << level;
    }
}

TEST(EnclosedMove, AnOrientationIsExactOrOpen) {
    Random random(9);
    int clear = 0;
    for (int i = 0; i < 4000; ++i) {
        const Vec3 a = random.vector(), b = random.vector(), c = random.vector();
        const Vec3 d = a + random.unit() * (b - a) + random.unit() * (c - a) + random.real(-4, 4) * u * Vec3::Ones();
        const RVec3 o = exact::vector(d), p = exact::vector(a) - o, q = exact::vector(b) - o, r = exact::vector(c) - o;
        const Rational determinant = p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0]) +
                                     p[2] * (q[0] * r[1] - q[1] * r[0]);
        const int sign = orientation(a, b, c, d);
        clear += sign != 0;
        EXPECT_TRUE(sign == 0 || sign == (determinant > 0 ? 1 : determinant < 0 ? -1 : 0)) << i;
    }
    EXPECT_GT(clear, 40);
    EXPECT_LT(clear, 3900);
}

TEST(EnclosedMove, ClosedIsWhatHasEvenEdges) {
    EXPECT_TRUE(is_closed(cube(1)));
    EXPECT_FALSE(is_closed(sheet(4, 0)));
    TriangleMesh open = cube(1);
    open.triangles.conservativeResize(11, 3);
    EXPECT_FALSE(is_closed(open));
}

// B has small triangles below each corner of A and below the point whose crossings are counted;
// the points between them are farther from B.
TEST(Tang, AnOpenMeshIsNotTakenForAClosedOne) {
    const Triangle t{{0, 0, 0.1}, {1, 0, 0.1}, {0, 1, 0.1}};
    Points b(12, 3);
    Index row = 0;
    for (const Vec3& p : {t.a, t.b, t.c, Vec3(0.5 * t.a + 0.3 * t.b + 0.2 * t.c)}) {
        for (const Vec3& corner : {Vec3(-0.01, -0.01, -0.1), Vec3(0.03, 0, -0.1), Vec3(0, 0.04, -0.1)})
            b.row(row++) = p + corner;
    }
    const Scene scene{soup(rows({t.a, t.b, t.c})), soup(b)};
    const Result plain = solve(scene, asking(1e-3)), moved = solve(scene, asking(1e-3), {{"lemma4", true}});
    EXPECT_GT(plain.bounds.lower, 0.3);
    EXPECT_EQ(plain.bounds.upper, moved.bounds.upper);
    EXPECT_EQ(plain.counters, moved.counters);
}

// The cube's top is flat: the planes of its two triangles do not say where to cut.
TEST(Tang, Lemma4SavesSubdivisions) {
    const TriangleMesh b = cube(1);
    const Triangle t{{-0.5, -0.5, 1.1}, {0.6, -0.4, 1.1}, {-0.3, 0.7, 1.1}};
    const Scene scene{soup(rows({t.a, t.b, t.c})), b};
    const Result plain = solve(scene, asking(1e-3)), moved = solve(scene, asking(1e-3), {{"lemma4", true}});
    EXPECT_EQ(to_string(moved.status), "converged");
    EXPECT_LE(moved.bounds.upper, 1.001 * 0.1 + 0.001);
    EXPECT_GT(plain.counters.subdivisions, 0u);
    EXPECT_EQ(moved.counters.subdivisions, 0u);
}

// --- the solver ------------------------------------------------------------------------------------------------------

TEST(Tang, IntervalsHoldTheAnswerOfTheReference) {
    Random random(6);
    int converged = 0, count = 0;
    for (int i = 0; i < 200; ++i) {
        const Scene scene = small_scene(random, i);
        const auto truth = truth_of(scene);
        for (std::size_t k = 0; k < options().size(); ++k) {
            Query query = asking(1e-5);
            query.budget = 20000;
            const Result result = solve(scene, query, options()[k]);
            const std::string where = "options " + std::to_string(k) + ", scene " + std::to_string(i);
            expect_sound(result, truth, 1e-5, where);
            converged += result.status == Status::converged, ++count;
            EXPECT_TRUE(result.status == Status::converged || result.status == Status::budget) << where;
        }
    }
    EXPECT_GE(converged, 0.95 * count);
}

// For a moved A, culling uses moved volumes. The answer must agree with the answer for a mesh moved beforehand.
TEST(Tang, APoseOfAHasTheAnswerOfTheMovedMesh) {
    Random random(7);
    for (int i = 0; i < 60; ++i) {
        Query query = asking(1e-7);
        query.source_pose = any_pose(random, 1 + i % 2);
        const TriangleMesh a = sheet(9, 0.1, 0.2), b = sheet(8, 0, 0.3);
        TriangleMesh moved = a;
        moved.vertices = posed(a.vertices, query.source_pose);
        const Result there = solve({moved, b}, asking(1e-7));
        for (const ParameterMap& given : options()) {
            const Result result = solve({a, b}, query, given);
            EXPECT_EQ(to_string(result.status), "converged") << i;
            EXPECT_LE(result.bounds.lower, there.bounds.upper) << i;
            EXPECT_LE(there.bounds.lower, result.bounds.upper) << i;
        }
    }
}

void expect_holds(const Result& result, const Rational& squared, const std::string& where) {
    EXPECT_TRUE(Rational(result.bounds.lower) * result.bounds.lower <= squared) << where;
    EXPECT_TRUE(Rational(result.bounds.upper) * result.bounds.upper >= squared) << where;
}

// B is a few points, so the exact distance is known.
TEST(Tang, BoundsHoldExactlyAtThePrecisionFloor) {
    Random random(5);
    for (std::size_t k = 0; k < options().size(); ++k) {
        for (int i = 0; i < 100; ++i) {
            const Vec3 offset = i % 2 == 0 ? Vec3::Ones() : Vec3::Zero();
            const double size = i % 2 == 0 ? 0.25 : 1;
            const auto any_point = [&] { return Vec3(offset + size * random.vector().cwiseAbs()); };
            const Triangle a{any_point(), any_point(), any_point()};
            std::vector<Vec3> b;
            for (int j = 0; j <= i % 3; ++j) b.push_back(any_point());
            const Scene scene{soup(rows({a.a, a.b, a.c})), points_as_triangles(b)};
            const std::string where = "options " + std::to_string(k) + ", scene " + std::to_string(i);
            const Result result = solve(scene, asking(1e-30), options()[k]);
            expect_holds(result, exact_squared(a, b), where);
            EXPECT_LT(result.bounds.gap(), 2e-13) << where;
            Query query = asking(1e-30);
            query.time_limit = 1e-12;
            expect_holds(solve(scene, query, options()[k]), exact_squared(a, b), where + ", no time");
        }
    }
}

// Roundings of many cuts never all err in one direction, but the bounds must include the derived error.
TEST(Tang, BoundsAreWidenedByTheLevelOfTheirPiece) {
    const Triangle a{{0, 0, 0}, {1, 0, 0}, {0.5, 0.01, 0}};
    const std::vector<Vec3> b{{0.1, -0.3, 0}, {0.8, -0.25, 0}};
    const Scene scene{soup(rows({a.a, a.b, a.c})), points_as_triangles(b)};
    const Rational squared = exact_squared(a, b), least = 40 * Rational(u);
    for (const char* split : {"midpoint", "longest_edge", "voronoi"}) {
        const Result result = solve(scene, asking(1e-30), {{"split", std::string(split)}});
        const Rational lower = result.bounds.lower + least, upper = result.bounds.upper - 110 * Rational(u);
        EXPECT_TRUE(lower * lower <= squared) << split;
        EXPECT_TRUE(upper * upper >= squared) << split;
    }
}

// Triangles culled with a tree node keep the bound of the node's volume, widened by the error of the closest point. All
// of A is 1 from B, below the floor.
TEST(Tang, ACulledNodeKeepsItsBoundAndIsWidened) {
    std::vector<Vec3> a(9, Vec3(1, 0, 0));
    a.resize(18, Vec3(9, 0, 0));
    const Scene scene{points_as_triangles(a), points_as_triangles({{0, 0, 0}, {10, 0, 0}, {-1000, 0, 0}})};
    for (const ParameterMap& given : {options()[0], options()[1]}) {
        Query query = asking(1e-30);
        query.floor = 2;
        query.wanted.fields = true;
        const Result result = solve(scene, query, given);
        EXPECT_EQ(to_string(result.status), "below_floor");
        EXPECT_EQ(reported(result, "culled on A"), 1);
        std::vector<double> upper = (*result.fields)[1].values;
        upper.push_back(result.bounds.upper);
        for (const double bound : upper) {
            EXPECT_GE(bound, 1 + 7.9 * u * 1000);
            EXPECT_LE(bound, 1 + 1e-9);
        }
    }
}

// The cutoff ends the culling of A's tree early. Unvisited nodes, at every level, must count in the upper bound.
TEST(Tang, WhatIsLeftOfTheTreeCounts) {
    Random random(8);  // points, so that nothing is ever queued
    const Scene scene{PointSet{cloud(random, 3000)}, PointSet{cloud(random, 40)}};
    const double h = solve(scene, asking(1e-6)).bounds.lower;
    for (const ParameterMap& given : {options()[0], options()[1]}) {
        for (double part = 0.6; part < 1; part += 0.02) {
            Query query = asking(1e-6);
            query.cutoff = part * h;
            query.wanted.fields = true;
            const Result result = solve(scene, query, given);
            EXPECT_EQ(to_string(result.status), "above_cutoff");
            EXPECT_GE(result.bounds.upper, h);
            const std::vector<double>& upper = (*result.fields)[1].values;
            EXPECT_GE(result.bounds.upper, *std::max_element(upper.begin(), upper.end()));
        }
    }
}

// Fields must bound each triangle's distance, wherever the search ends and however the triangle was decided.
TEST(Tang, FieldsHoldOfEachTriangle) {
    const TriangleMesh a = sheet(10, 0.1, 0.2), b = sheet(12, 0, 0.1);
    const MeshReference reference(b);
    std::vector<std::pair<long double, long double>> truths;
    for (Index i = 0; i < a.triangles.rows(); ++i)
        truths.push_back(reference.hausdorff(a.vertices, Triangles(a.triangles.row(i)), 1e-6L));
    for (const ParameterMap& given : options()) {
        for (int kind = 0; kind < 5; ++kind) {
            Query query = asking(kind == 0 ? 1e-7 : 1e-3);
            if (kind == 1) query.budget = 3;
            if (kind == 2) query.time_limit = 0;
            if (kind == 3) query.floor = 0.35;
            if (kind == 4) query.cutoff = 0.2;
            query.wanted.fields = true;
            const Result result = solve({a, b}, query, given);
            const Field &lower = (*result.fields)[0], &upper = (*result.fields)[1];
            ASSERT_EQ(upper.values.size(), truths.size());
            double most = 0;
            for (std::size_t i = 0; i < truths.size(); ++i) {
                EXPECT_LE(lower.values[i], truths[i].second) << kind << ", " << i;
                EXPECT_GE(upper.values[i], truths[i].first) << kind << ", " << i;
                most = std::max(most, upper.values[i]);
            }
            EXPECT_LE(most, result.bounds.upper) << kind;
        }
    }
}

// Each corner of one mesh lies in several triangles of the other. Without group traversal, only a list of near
// triangles can show that one of them is nearest to all corners.
TEST(Tang, IdenticalMeshesNeedNoSplit) {
    const TriangleMesh mesh = sheet(12, 0, 0.3);
    TriangleMesh twice = mesh;
    twice.triangles.conservativeResize(2 * mesh.triangles.rows(), 3);
    twice.triangles.bottomRows(mesh.triangles.rows()) = mesh.triangles;
    for (const ParameterMap& given : options()) {
        for (const TriangleMesh& b : {mesh, twice}) {
            const Result result = solve({mesh, b}, asking(1e-9), given);
            EXPECT_EQ(to_string(result.status), "converged");
            EXPECT_EQ(result.bounds.lower, 0);
            EXPECT_EQ(result.counters.subdivisions, 0u);
        }
    }
}

// Too many triangles are near for a list, so closest-point queries must take over.
TEST(Tang, StackedDuplicatesConverge) {
    const TriangleMesh layer = sheet(3, 0, 0.3);
    TriangleMesh many = layer;
    many.triangles.resize(100 * layer.triangles.rows(), 3);
    for (Index k = 0; k < 100; ++k)
        many.triangles.middleRows(k * layer.triangles.rows(), layer.triangles.rows()) = layer.triangles;
    const TriangleMesh a = sheet(4, 0.2, 0.3);
    for (const ParameterMap& given : options()) {
        const Result result = solve({a, many}, asking(1e-5), given), single = solve({a, layer}, asking(1e-5), given);
        EXPECT_EQ(to_string(result.status), "converged");
        EXPECT_LE(result.bounds.lower, single.bounds.upper);
        EXPECT_LE(single.bounds.lower, result.bounds.upper);
    }
}

TEST(Tang, ListsTakeThePlaceOfQueries) {
    const Result result = solve({sheet(12, 0.05, 0.2), sheet(17, 0, 0.2)}, asking(1e-6));
    EXPECT_GT(result.counters.subdivisions, 30u);
    EXPECT_LT(result.counters.closest_point_queries, result.counters.subdivisions);
    EXPECT_GT(reported(result, "depth"), 1);
    EXPECT_LE(reported(result, "depth"), 16);
}

// A has one peak far from B. All the rest must be culled by tree nodes, and most of B never visited.
TEST(Tang, CullsOnBothSides) {
    TriangleMesh a = sheet(60, 0.5, 0.1);
    a.vertices(30 * 60 + 30, 2) = 9;
    const Scene scene{a, sheet(50, 0, 0.1)};
    for (const ParameterMap& given : options()) {
        const Result result = solve(scene, asking(1e-6), given);
        EXPECT_EQ(to_string(result.status), "converged");
        EXPECT_GE(reported(result, "culled on A"), 0.95);
        EXPECT_GE(reported(result, "culled on B"), 0.9);
    }
}

TEST(Tang, AWarmStartBeginsAtTheFarthestPoint) {
    const Scene scene{sheet(30, 0.5, 0.4), sheet(30, 0, 0.1)};
    const Session session = session_for(scene, {}, {.moves = true});
    const auto state = session.begin();
    Trace trace;
    const Result first = session.solve(asking(1e-6), state.get(), trace);
    EXPECT_EQ(first.counters, session.solve(asking(1e-6), trace).counters);
    Query query = asking(1e-6);
    query.time_limit = 1e-12;  // only the first point is measured
    EXPECT_EQ(session.solve(query, trace).bounds.lower, 0);
    EXPECT_EQ(session.solve(query, state.get(), trace).bounds.lower, first.bounds.lower);
    // Here the farthest point is not a corner of A. A warm start must find it again, up to rounding.
    const Session peak = session_for({soup(rows({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})),
                                      points_as_triangles({{0, 0, 0.25}, {1, 0, 0.25}, {0, 1, 0.25}, {-1000, 0, 0}})},
                                     {}, {.moves = true});
    const auto there = peak.begin();
    const Result inner = peak.solve(asking(1e-6), there.get(), trace), again = peak.solve(query, there.get(), trace);
    EXPECT_NEAR(again.bounds.lower, inner.bounds.lower, 1e-11);
    const double far = std::sqrt(squared_length(Vec3(0.5, 0.5, 0.25)));
    EXPECT_LE(again.bounds.lower, far - 1.99 * level_of_closest_point * u * 1000);
}

}  // namespace
}  // namespace hausbench
