// The octree must give the bits of a plain scan, on tame and on hostile meshes.
#include "kernel/octree.h"
#include "random.h"

#include <gtest/gtest.h>

namespace hausbench {
namespace {

TriangleMesh soup(Random& random, Index count, double size) {
    TriangleMesh mesh;
    mesh.vertices.resize(3 * count, 3);
    mesh.triangles.resize(count, 3);
    for (Index i = 0; i < count; ++i) {
        const Vec3 centre = random.vector();
        for (int k = 0; k < 3; ++k) {
            mesh.vertices.row(3 * i + k) = centre + random.vector(size);
            mesh.triangles(i, k) = 3 * i + k;
        }
    }
    return mesh;
}

std::vector<std::pair<std::string, TriangleMesh>> meshes() {
    Random random(3);
    std::vector<std::pair<std::string, TriangleMesh>> all;
    all.emplace_back("one triangle", soup(random, 1, 0.5));
    all.emplace_back("small triangles", soup(random, 3000, 0.02));
    all.emplace_back("large triangles", soup(random, 300, 0.7));
    all.emplace_back("duplicates", soup(random, 100, 0.1));
    TriangleMesh& duplicates = all.back().second;
    for (Index i = 0; i < 60; ++i) duplicates.triangles.row(i) = duplicates.triangles.row(70);
    all.emplace_back("points", soup(random, 100, 0));
    all.emplace_back("all in one point", soup(random, 40, 0));
    all.back().second.vertices.setConstant(0.25);
    all.emplace_back("sizes 1 : 1e9", soup(random, 200, 1e-9));
    all.back().second.vertices.topRows(30) *= 1e-9;
    all.emplace_back("a plane", soup(random, 500, 0.1));
    all.back().second.vertices.col(2).setConstant(0.5);
    // A grid: most closest points lie on shared edges and vertices.
    TriangleMesh grid;
    grid.vertices.resize(100, 3);
    grid.triangles.resize(162, 3);
    for (Index i = 0; i < 100; ++i) grid.vertices.row(i) = Vec3(0.125 * (i % 10), 0.125 * (i / 10), 0);
    Index t = 0;
    for (Index y = 0; y < 9; ++y) {
        for (Index x = 0; x < 9; ++x) {
            const Index v = 10 * y + x;
            grid.triangles.row(t++) << v, v + 1, v + 10;
            grid.triangles.row(t++) << v + 1, v + 11, v + 10;
        }
    }
    all.emplace_back("grid", grid);
    return all;
}

Vec3 query(const TriangleMesh& mesh, Random& random) {
    const Index v = random.below(static_cast<Index>(mesh.vertices.rows()));
    const Vec3 vertex = mesh.vertices.row(v);
    switch (random.below(4)) {
        case 0: return random.vector(2);
        case 1: return vertex;
        case 2: return vertex + random.vector(1e-7);
        default: return Vec3(0.0625 * random.below(32), 0.0625 * random.below(32), 0.25 * random.below(3));
    }
}

void expect_same(const ClosestPoint& a, const ClosestPoint& b, const std::string& where) {
    EXPECT_EQ(a.squared_distance, b.squared_distance) << where;
    EXPECT_EQ(a.triangle, b.triangle) << where;
    EXPECT_EQ(a.point, b.point) << where;
}

TEST(Octree, SameBitsAsAScan) {
    Random random(4);
    for (const auto& [name, mesh] : meshes()) {
        const TriangleOctree octree(mesh);
        Counters counters;
        for (int i = 0; i < 300; ++i) {
            const Vec3 point = query(mesh, random);
            const ClosestPoint expected = closest_by_scan(mesh, point, {}, counters);
            ASSERT_GE(expected.triangle, 0);
            expect_same(octree.closest(point, {}, counters), expected, name);

            ClosestHints warm;
            warm.warm_triangle = random.below(static_cast<Index>(mesh.triangles.rows()));
            expect_same(octree.closest(point, warm, counters), expected, name + ", warm");

            ClosestHints radius;
            radius.squared_radius = expected.squared_distance;
            expect_same(octree.closest(point, radius, counters), expected, name + ", radius just large enough");
            radius.squared_radius = std::nextafter(expected.squared_distance, -1);
            EXPECT_EQ(octree.closest(point, radius, counters).triangle, -1) << name;

            EXPECT_EQ(octree.certified_distance(point, counters), certified_distance_by_scan(mesh, point, counters)) << name;
        }
    }
}

TEST(Octree, EarlyOutStopsAtATriangleNearEnough) {
    Random random(5);
    const TriangleMesh mesh = soup(random, 2000, 0.1);
    const TriangleOctree octree(mesh);
    Counters full, early;
    for (int i = 0; i < 300; ++i) {
        const Vec3 point = random.vector();
        ClosestHints hints;
        hints.squared_enough = 0.01;
        const double nearest = octree.closest(point, {}, full).squared_distance;
        const ClosestPoint found = octree.closest(point, hints, early);
        EXPECT_GE(found.squared_distance, nearest);
        EXPECT_TRUE(nearest <= 0.01 ? found.squared_distance <= 0.01 : found.squared_distance == nearest);
    }
    EXPECT_LT(early.point_triangle_distances, full.point_triangle_distances);
}

TEST(Octree, LooksAtFewTriangles) {
    Random random(6);
    const TriangleMesh mesh = soup(random, 20000, 0.01);
    const TriangleOctree octree(mesh);
    Counters counters, again;
    for (int i = 0; i < 200; ++i) (void)octree.closest(random.vector(), {}, counters);
    EXPECT_EQ(counters.closest_point_queries, 200u);
    EXPECT_LT(counters.point_triangle_distances, 200u * 200u);
    EXPECT_GT(octree.bytes(), 20000u * sizeof(Triangle));

    Random one(7), two(7);
    counters = {};
    for (int i = 0; i < 50; ++i) (void)octree.closest(one.vector(), {}, counters);
    for (int i = 0; i < 50; ++i) (void)octree.closest(two.vector(), {}, again);
    EXPECT_EQ(counters, again);
}

}  // namespace
}  // namespace hausbench
