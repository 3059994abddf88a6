// Groups of triangles of A (search/source_regions.h): their bounds against exact distances, and the solvers that use
// them.
#include "algorithms/search/source_regions.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "algorithms/structures/bvh.h"
#include "algorithms/structures/octree.h"
#include "tests/support/exact_points.h"
#include "tests/support/reference.h"
#include "tests/support/scenes.h"

#include <set>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using exact::Rational;

TriangleMesh scaled(TriangleMesh mesh, double factor, const Vec3& offset) {
    mesh.vertices *= factor;
    mesh.vertices.rowwise() += offset.transpose();
    return mesh;
}

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
    TriangleMesh all;
    all.vertices.resize(a.vertices.rows() + b.vertices.rows(), 3);
    all.vertices << a.vertices, b.vertices;
    all.triangles.resize(a.triangles.rows() + b.triangles.rows(), 3);
    all.triangles << a.triangles, b.triangles.array() + static_cast<Index>(a.vertices.rows());
    return all;
}

// Returns two meshes too large for a plain scan: far apart, near, with a stray part, parallel, random, or of different
// sizes.
std::pair<TriangleMesh, TriangleMesh> pair_of(Random& random, int i) {
    const TriangleMesh a = sheet(12, 0, 0.3), small = scaled(sheet(7, 0, 0.2), 0.2, random.vector(5));
    switch (i % 6) {
        case 0:
            return {a, scaled(small, 1, Vec3(random.vector(30)))};
        case 1:
            return {a, scaled(sheet(9, 0, 0.4), 1.3, Vec3(0, 0, random.real(-1, 1)))};
        case 2:
            return {joined(a, scaled(small, 1, Vec3(40, 0, 0))), scaled(a, 1, Vec3(0, 0, 0.5))};
        case 3:
            return {sheet(12, 0), sheet(9, 2)};
        case 4:
            return {soup(cloud(random, 3 * 60)), soup(cloud(random, 3 * 40))};
        default:
            return {scaled(a, 1e-6, Vec3(random.vector())), small};
    }
}

Pose turned(Random& random) {
    Pose pose;
    pose.rotation = Eigen::AngleAxisd(random.real(0, 3), random.vector().normalized()).toRotationMatrix();
    pose.translation = random.vector(3);
    return pose;
}

Rational exact_squared_distance(const Vec3& p, const TriangleMesh& b) {
    Rational least = -1;
    for (Index j = 0; j < b.triangles.rows(); ++j) {
        const Triangle t = triangle_of(b, j);
        const Rational squared = exact::squared_distance_to_triangle(exact::vector(p), exact::vector(t.a),
                                                                     exact::vector(t.b), exact::vector(t.c));
        if (least < 0 || squared < least) least = squared;
    }
    return least;
}

TEST(SourceRegions, SettlesOrShowsEachTriangleOnceAndItsBoundHolds) {
    Random random(1);
    std::size_t settled = 0;
    for (int i = 0; i < 48; ++i) {
        const auto [a, b] = pair_of(random, i);
        const Pose pose = i % 2 ? turned(random) : Pose();
        const Points points = posed(a.vertices, pose);
        const TriangleBvh bvh(a), target_bvh(b);
        const TriangleOctree octree(a);
        const Target target(b, &target_bvh);
        Counters counters;
        Trace trace;
        Query query;
        SearchBounds bounds(query, target, {std::max(magnitude(points), magnitude(b.vertices))}, counters, trace);
        const TriangleTree& tree = i % 4 < 2 ? static_cast<const TriangleTree&>(bvh) : octree;
        SourceRegions regions(tree, points, pose, target, bounds, counters);
        std::multiset<Index> seen;
        std::vector<Vec3> left_out;
        std::vector<double> uppers;
        const bool done = regions.walk(
            [&, &source = a](Index triangle, Index near) {
                seen.insert(triangle);
                for (const Index v : source.triangles.row(triangle)) bounds.measure(points.row(v), near, triangle, 0);
            },
            [&, &source = a](Index triangle, double upper, Index) {
                seen.insert(triangle);
                EXPECT_LE(upper, bounds.purged_at_most(0));
                const Index v = source.triangles(triangle, static_cast<Index>(random.below(3)));
                left_out.push_back(points.row(v));
                uppers.push_back(upper);
            });
        ASSERT_TRUE(done);
        EXPECT_EQ(seen.size(), static_cast<std::size_t>(a.triangles.rows())) << i;
        EXPECT_EQ(std::set<Index>(seen.begin(), seen.end()).size(), seen.size()) << i;
        for (std::size_t k = 0; k < left_out.size(); k += 1 + left_out.size() / 12)
            EXPECT_TRUE(Rational(uppers[k]) * Rational(uppers[k]) >= exact_squared_distance(left_out[k], b)) << i;
        settled += left_out.size();
    }
    EXPECT_GT(settled, 2000U);  // of about 10,000
}

// Returns the first upper bound of each triangle of A; a high floor makes the search accept it.
std::vector<double> first_bounds(const TriangleMesh& a, const TriangleMesh& b, const Pose& pose, double magnitude) {
    const Points points = posed(a.vertices, pose);
    const TriangleBvh tree(a), target_tree(b);
    const Target target(b, &target_tree);
    Counters counters;
    Trace trace;
    Query query;
    query.floor = 1e9;
    SearchBounds bounds(query, target, {magnitude}, counters, trace);
    SourceRegions regions(tree, points, pose, target, bounds, counters);
    std::vector<double> uppers;
    EXPECT_TRUE(
        regions.walk([](Index, Index) { FAIL(); }, [&](Index, double upper, Index) { uppers.push_back(upper); }));
    return uppers;
}

// A flat square is turned upright, so its far edge is farther from B than its middle, and than its box before the turn.
TEST(SourceRegions, TheFarthestCornerOfThePosedBoxCounts) {
    const TriangleMesh a = scaled(sheet(12, 0), 0.1, Vec3(0, 0, 0)), b = scaled(sheet(7, 0), 0.01, Vec3(0, 0, -9));
    Pose pose;
    pose.rotation << 0, 0, 1, 0, 1, 0, -1, 0, 0;  // x becomes -z
    pose.translation = Vec3(0, 0, 5);
    const std::vector<double> uppers = first_bounds(a, b, pose, 16);
    ASSERT_EQ(uppers.size(), static_cast<std::size_t>(a.triangles.rows()));
    // B lies in the plane z = -9, and the turned square reaches z = 5, so bounds must be at least 14, but not much
    // above what the diagonal of the box gives.
    EXPECT_GE(*std::min_element(uppers.begin(), uppers.end()), 14);
    EXPECT_LE(uppers[0], std::sqrt(14.0 * 14 + 1.2 * 1.2) + 0.01);
    // Bounds are widened like a vertex's: by 8 * u * M, including the 7 * u * M by which a closest point may be off B.
    const double magnitude = 0x1p40;
    EXPECT_GE(first_bounds(a, b, pose, magnitude)[0] - uppers[0], 7 * unit_roundoff * magnitude);
    EXPECT_LE(first_bounds(a, b, pose, magnitude)[0] - uppers[0], 9 * unit_roundoff * magnitude);
}

Result solve(const std::string& name, const Scene& scene, const Query& query, const ParameterMap& given) {
    const SolverEntry& entry = find_solver(name);
    const Session session(entry, Options(name, entry.info.parameters, given), scene, {});
    Trace trace;
    return session.solve(query, trace);
}

TEST(SourceRegions, ChangeNoAnswerOfASolver) {
    Random random(2);
    for (int i = 0; i < 36; ++i) {
        const auto [a, b] = pair_of(random, i);
        const Scene scene{a, b};
        Query query;
        query.tolerance = {Tolerance::Of::absolute, 1e-4};
        query.budget = 20000;
        query.wanted.fields = i % 3 == 0;
        if (i % 2) query.source_pose = turned(random);
        if (i % 5 == 0) query.floor = 0.5;
        const Points points = posed(a.vertices, query.source_pose);
        const auto truth = MeshReference(b).hausdorff(points, a.triangles, 1e-4L);
        for (const char* name : {"guthe", "zheng", "sacht"}) {
            std::vector<Result> answers;
            for (const bool regions : {false, true})
                answers.push_back(solve(name, scene, query, {{"regions", regions}}));
            for (const Result& answer : answers) {
                EXPECT_LE(answer.bounds.lower, truth.second) << name << i;
                EXPECT_GE(answer.bounds.upper, truth.first) << name << i;
                EXPECT_EQ(answer.status, answers[0].status) << name << i;
            }
            if (!query.wanted.fields) continue;
            const auto &without = answers[0].fields.value(), &with = answers[1].fields.value();
            ASSERT_EQ(with[1].name, "upper");
            for (std::size_t t = 0; t < with[1].values.size(); ++t) {
                EXPECT_GE(with[1].values[t], without[0].values[t]) << name << i;  // upper against lower bound
                EXPECT_GE(without[1].values[t], with[0].values[t]) << name << i;
            }
        }
    }
}

// Even if bounds alone could answer the query, the solver must measure a point and give a witness.
TEST(SourceRegions, LeaveAWitness) {
    const TriangleMesh copies = points_as_triangles(std::vector<Vec3>(40, Vec3(1, 2, 3)));
    const Scene same{copies, copies}, apart{sheet(12, 0), sheet(12, 3)};
    Query query;
    query.tolerance = {Tolerance::Of::absolute, 1e-4};
    for (const char* name : {"guthe", "zheng"}) {
        EXPECT_GE(solve(name, same, query, {}).witness.source_element, 0) << name;
        Query floored = query;
        floored.floor = 50;
        const Result below = solve(name, apart, floored, {});
        EXPECT_EQ(below.status, Status::below_floor) << name;
        EXPECT_GE(below.witness.source_element, 0) << name;
        EXPECT_GT(below.bounds.lower, 2.99) << name;
    }
}

TEST(SourceRegions, FarPairsNeedFewQueries) {
    const Scene scene{sheet(40, 0, 0.3), scaled(sheet(40, 0, 0.3), 1, Vec3(100, 0, 0))};
    Query query;
    query.tolerance = {Tolerance::Of::absolute, 1e-4};
    for (const char* name : {"guthe", "zheng", "kang"}) {
        const Result without = solve(name, scene, query, {{"regions", false}}),
                     with = solve(name, scene, query, {{"regions", true}});
        EXPECT_EQ(without.bounds.lower, with.bounds.lower);
        EXPECT_LT(5 * with.counters.closest_point_queries, without.counters.closest_point_queries) << name;
    }
}

}  // namespace
}  // namespace hausbench
