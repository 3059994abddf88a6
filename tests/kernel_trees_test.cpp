// Octree and BVH must give the bits of a plain scan, on tame and on hostile meshes.
#include "kernel/bvh.h"
#include "kernel/octree.h"
#include "tree_meshes.h"

#include <gtest/gtest.h>

namespace hausbench {
namespace {

template <class Tree> class Trees : public testing::Test {};
using Kinds = testing::Types<TriangleOctree, TriangleBvh>;
TYPED_TEST_SUITE(Trees, Kinds);

void expect_same(const ClosestPoint& a, const ClosestPoint& b, const std::string& where) {
    EXPECT_EQ(a.squared_distance, b.squared_distance) << where;
    EXPECT_EQ(a.triangle, b.triangle) << where;
    EXPECT_EQ(a.point, b.point) << where;
}

void expect_same_as_scan(const TriangleTree& tree, const TriangleMesh& mesh, Random& random, int queries,
                         const std::string& name) {
    Counters counters;
    for (int i = 0; i < queries; ++i) {
        const Vec3 point = query_near(mesh, random);
        const ClosestPoint expected = closest_by_scan(mesh, point, {}, counters);
        ASSERT_GE(expected.triangle, 0);
        expect_same(tree.closest(point, {}, counters), expected, name);

        ClosestHints warm;
        warm.warm_triangle =
            random.below(2) != 0 ? expected.triangle : random.below(static_cast<Index>(mesh.triangles.rows()));
        expect_same(tree.closest(point, warm, counters), expected, name + ", warm");

        ClosestHints radius;
        radius.squared_radius = expected.squared_distance;
        expect_same(tree.closest(point, radius, counters), expected, name + ", radius just large enough");
        radius.squared_radius = std::nextafter(expected.squared_distance, -1);
        EXPECT_EQ(tree.closest(point, radius, counters).triangle, -1) << name;
        radius.warm_triangle = warm.warm_triangle;
        EXPECT_EQ(tree.closest(point, radius, counters).triangle, -1) << name;

        EXPECT_EQ(tree.certified_distance(point, counters), certified_distance_by_scan(mesh, point, counters)) << name;
    }
}

TYPED_TEST(Trees, SameBitsAsAScanOn200Meshes) {
    Random random(4);
    const auto meshes = tree_meshes();
    ASSERT_EQ(meshes.size(), 200u);
    for (const auto& [name, mesh] : meshes) {
        const TypeParam tree(mesh);
        expect_same_as_scan(tree, mesh, random, mesh.triangles.rows() > 1000 ? 100 : 200, name);
        std::vector<Index> order = tree.tree().order;
        std::sort(order.begin(), order.end());
        for (std::size_t i = 0; i < order.size(); ++i) ASSERT_EQ(order[i], static_cast<Index>(i)) << name;
        ASSERT_EQ(order.size(), static_cast<std::size_t>(mesh.triangles.rows())) << name;
    }
}

TYPED_TEST(Trees, RefitFollowsTheVertices) {
    Random random(7);
    const TriangleMesh before = triangle_soup(random, 500, 0.1);
    TypeParam tree(before);
    TriangleMesh after = before;
    for (Index v = 0; v < after.vertices.rows(); ++v) after.vertices.row(v) += random.vector(0.5);
    after.vertices *= 30;
    tree.refit(after);
    expect_same_as_scan(tree, after, random, 300, "refit");
}

TYPED_TEST(Trees, EarlyOutStopsAtATriangleNearEnough) {
    Random random(5);
    const TriangleMesh mesh = triangle_soup(random, 2000, 0.1);
    const TypeParam tree(mesh);
    Counters full, early;
    for (int i = 0; i < 300; ++i) {
        const Vec3 point = random.vector();
        ClosestHints hints;
        hints.squared_enough = 0.01;
        const double nearest = tree.closest(point, {}, full).squared_distance;
        const ClosestPoint found = tree.closest(point, hints, early);
        EXPECT_GE(found.squared_distance, nearest);
        EXPECT_TRUE(nearest <= 0.01 ? found.squared_distance <= 0.01 : found.squared_distance == nearest);
    }
    EXPECT_LT(early.point_triangle_distances, full.point_triangle_distances);
}

TYPED_TEST(Trees, LooksAtFewTriangles) {
    Random random(6);
    const TriangleMesh mesh = triangle_soup(random, 20000, 0.01);
    const TypeParam tree(mesh);
    Counters counters, again;
    for (int i = 0; i < 200; ++i) (void)tree.closest(random.vector(), {}, counters);
    EXPECT_EQ(counters.closest_point_queries, 200u);
    EXPECT_LT(counters.point_triangle_distances, 200u * 100u);
    EXPECT_LT(counters.node_visits, 200u * 500u);
    EXPECT_GT(tree.bytes(), 20000u * sizeof(Triangle));

    Random one(7), two(7);
    counters = {};
    for (int i = 0; i < 50; ++i) (void)tree.closest(one.vector(), {}, counters);
    for (int i = 0; i < 50; ++i) (void)tree.closest(two.vector(), {}, again);
    EXPECT_EQ(counters, again);
}

void expect_nearest_as_by_scan(const PointBvh& tree, const Points& points, Random& random) {
    Counters counters;
    for (int i = 0; i < 300; ++i) {
        const Vec3 p =
            i % 3 == 0 ? Vec3(points.row(random.below(static_cast<Index>(points.rows())))) : random.vector(2);
        NearestPoint expected;
        for (Index k = 0; k < points.rows(); ++k) {
            const double squared = squared_length(p - Vec3(points.row(k)));
            if (squared < expected.squared_distance) expected = {squared, k};
        }
        constexpr double infinity = std::numeric_limits<double>::infinity();
        const NearestPoint found = tree.nearest(p, infinity, -1, counters);
        EXPECT_EQ(found.squared_distance, expected.squared_distance);
        EXPECT_EQ(found.point, expected.point);
        EXPECT_EQ(tree.nearest(p, expected.squared_distance, -1, counters).point, expected.point);
        EXPECT_EQ(tree.nearest(p, std::nextafter(expected.squared_distance, -1), -1, counters).point, -1);
        const NearestPoint enough = tree.nearest(p, infinity, 0.1, counters);
        EXPECT_TRUE(enough.squared_distance <= 0.1 || enough.squared_distance == expected.squared_distance);
    }
    EXPECT_GT(tree.bytes(), static_cast<std::size_t>(points.rows()) * sizeof(Vec3));
}

TEST(PointBvh, NearestPointAsByAScan) {
    Random random(8);
    for (const Index count : {1, 7, 8, 9, 100, 3000}) {
        Points points(count, 3);
        for (Index i = 0; i < count; ++i) points.row(i) = random.vector();
        for (Index i = 0; i < count / 4; ++i) points.row(i) = points.row(count - 1 - i);  // ties
        PointBvh tree(points);
        expect_nearest_as_by_scan(tree, points, random);
        for (Index i = 0; i < count; ++i) points.row(i) += 0.3 * random.vector();
        tree.refit(points);
        expect_nearest_as_by_scan(tree, points, random);
    }
}

}  // namespace
}  // namespace hausbench
