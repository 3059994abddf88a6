// Octree, BVH and uniform grid must give the bits of a plain scan, on tame and hostile meshes.
#include "algorithms/structures/bvh.h"
#include "algorithms/structures/octree.h"
#include "algorithms/structures/triangle_grid.h"
#include "tests/support/tree_meshes.h"

#include <array>

#include <gtest/gtest.h>

#include <fmt/format.h>

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

template <class Tree>
void expect_same_as_scan(const Tree& tree, const TriangleMesh& mesh, Random& random, int queries,
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

TEST(TriangleGrid, SameBitsAsAScanOn200Meshes) {
    Random random(4);
    for (const auto& [name, mesh] : tree_meshes())
        expect_same_as_scan(TriangleGrid(mesh), mesh, random, mesh.triangles.rows() > 1000 ? 50 : 100, name);
}

// Points far from the mesh, and on its outermost planes.
TEST(TriangleGrid, SameBitsAsAScanFarAway) {
    Random random(8);
    const TriangleMesh mesh = triangle_soup(random, 3000, 0.05);
    const TriangleGrid grid(mesh);
    Counters counters;
    for (int i = 0; i < 300; ++i) {
        Vec3 point = random.vector(std::pow(10, random.real(-1, 6)));
        if (i % 3 == 0) point[i % 2] = mesh.vertices(i, i % 2);
        expect_same(grid.closest(point, {}, counters), closest_by_scan(mesh, point, {}, counters), std::to_string(i));
    }
}

// One triangle spans the grid, and the others lie in one cell: memory must stay linear in the number of triangles.
TEST(TriangleGrid, TakesLinearMemoryHoweverTheTrianglesLie) {
    Random random(9);
    for (const double size : {1e-9, 1e-4, 0.05, 0.5, 3.0}) {
        TriangleMesh mesh = triangle_soup(random, 4000, size);
        EXPECT_LE(TriangleGrid(mesh).bytes(), 100 * 4000U) << size;
        for (int k = 0; k < 3; ++k) mesh.vertices.row(k) = 100 * random.vector();
        EXPECT_LE(TriangleGrid(mesh).bytes(), 100 * 4000U) << size << ", one triangle far away";
    }
}

TYPED_TEST(Trees, EarlyOutStopsAtATriangleNearEnough) {
    Random random(5);
    const TriangleMesh mesh = triangle_soup(random, 2000, 0.1);
    const TypeParam tree(mesh);
    Counters full, early;
    for (int i = 0; i < 300; ++i) {
        const Vec3 point = random.vector();
        ClosestHints hints;
        hints.early_out_squared = 0.01;
        const double nearest = tree.closest(point, {}, full).squared_distance;
        const ClosestPoint answer = tree.closest(point, hints, early);
        EXPECT_GE(answer.squared_distance, nearest);
        EXPECT_TRUE(nearest <= 0.01 ? answer.squared_distance <= 0.01 : answer.squared_distance == nearest);
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

    Random first(7), second(7);
    counters = {};
    for (int i = 0; i < 50; ++i) (void)tree.closest(first.vector(), {}, counters);
    for (int i = 0; i < 50; ++i) (void)tree.closest(second.vector(), {}, again);
    EXPECT_EQ(counters, again);
}

// --- scales far apart --------------------------------------------------------------------------------------------------

// Counts the work of queries near a grid of triangles. If `ratio` > 1, a stray triangle or a copy of the grid lies
// about `ratio` grid sizes away.
template <class Tree> Counters work_beside_a_stray_triangle(double ratio, bool two_clusters) {
    Random random(11);
    TriangleMesh mesh = triangle_grid(random, 40, 0.05);
    const TriangleMesh cluster = mesh;
    if (ratio > 1) {
        const Index vertices = static_cast<Index>(mesh.vertices.rows()),
                    triangles = static_cast<Index>(mesh.triangles.rows());
        const Index more = two_clusters ? triangles : 1;
        mesh.vertices.conservativeResize(2 * vertices, 3);
        mesh.triangles.conservativeResize(triangles + more, 3);
        const Vec3 away(5 * ratio, 3 * ratio, -4 * ratio);
        for (Index v = 0; v < vertices; ++v) mesh.vertices.row(vertices + v) = Vec3(cluster.vertices.row(v)) + away;
        for (Index t = 0; t < more; ++t) {
            for (int k = 0; k < 3; ++k) mesh.triangles(triangles + t, k) = cluster.triangles(t, k) + vertices;
        }
    }
    const Tree tree(mesh);
    Counters counters, scanned;
    for (int i = 0; i < 300; ++i) {
        const Vec3 point = Vec3(cluster.vertices.row(random.below(1600))) + random.vector(0.1);
        const ClosestPoint answer = tree.closest(point, {}, counters);
        if (i % 30 == 0) expect_same(answer, closest_by_scan(mesh, point, {}, scanned), fmt::format("ratio {}", ratio));
    }
    return counters;
}

TYPED_TEST(Trees, WorkDoesNotGrowWithTheRatioOfScales) {
    for (const bool two_clusters : {false, true}) {
        const Counters tame = work_beside_a_stray_triangle<TypeParam>(1, two_clusters);
        for (const double ratio : {10.0, 1e3, 1e6, 1e9, 1e12}) {
            const Counters counters = work_beside_a_stray_triangle<TypeParam>(ratio, two_clusters);
            EXPECT_LE(counters.node_visits, 2 * tame.node_visits) << ratio;
            EXPECT_LE(counters.point_triangle_distances, 2 * tame.point_triangle_distances) << ratio;
        }
    }
}

TYPED_TEST(Trees, WorkDoesNotGrowWithTheDistanceOfThePoint) {
    Random random(12);
    const TriangleMesh mesh = triangle_grid(random, 40, 0.05);
    const TypeParam tree(mesh);
    Counters near;
    for (double ratio = 1; ratio < 2e12; ratio *= 1e3) {
        Counters counters, scanned;
        Random points(13);
        for (int i = 0; i < 200; ++i) {
            const Vec3 point = ratio * Vec3(7, 5, 6) + points.vector();
            const ClosestPoint answer = tree.closest(point, {}, counters);
            if (i % 20 == 0) expect_same(answer, closest_by_scan(mesh, point, {}, scanned), fmt::format("{}", ratio));
        }
        if (ratio == 1) near = counters;
        EXPECT_LE(counters.node_visits, 4 * near.node_visits) << ratio;
        EXPECT_LE(counters.point_triangle_distances, 4 * near.point_triangle_distances) << ratio;
    }
}

TYPED_TEST(Trees, TakeFewBytesWhereTrianglesShareVertices) {
    Random random(14);
    const TriangleMesh mesh = triangle_grid(random, 100, 0.05);
    EXPECT_LE(TypeParam(mesh).bytes(), 70 * static_cast<std::size_t>(mesh.triangles.rows()));
}

// --- boxes of a byte a plane -------------------------------------------------------------------------------------------

void expect_outward(QuantisedBoxes& quantised, std::span<const Box> boxes, const std::string& where) {
    EXPECT_GE(quantised.step, 0x1p-440) << where;
    EXPECT_EQ(quantised.step * quantised.inverse, 1) << where;
    for (std::size_t i = 0; i < tree_width; ++i) {
        const Box& box = boxes[i < boxes.size() ? i : 0];
        for (int k = 0; k < 3; ++k) {
            EXPECT_LE(quantised.plane(k, quantised.low(k, i)), box.low[k]) << where;
            EXPECT_GE(quantised.plane(k, quantised.high(k, i)), box.high[k]) << where;
            EXPECT_LE(quantised.low(k, i) * quantised.step, box.low[k] - quantised.origin[k]) << where;
            EXPECT_GE(quantised.high(k, i) * quantised.step, box.high[k] - quantised.origin[k]) << where;
        }
    }
}

// Corners whose difference from the origin is rounded to an integer number of steps, up or down.
TEST(QuantisedBoxes, PlanesAreNeverInside) {
    Random random(15);
    for (int i = 0; i < 20000; ++i) {
        const double origin = -0.5 - 3 * random.unit(), scale = std::ldexp(1.0, random.below(1400) - 1000);
        std::array<Box, 3> boxes;
        for (Box& box : boxes) {
            box.low = box.high = Vec3::Constant(origin);
            for (int k = 0; k < 3; ++k) {
                const double low = origin + random.below(200), high = std::max(low, origin + random.below(256));
                const auto near = [&](double x) {  // a few units in the last place of a smaller number
                    return x + (random.below(9) - 4) * 0x1p-55 * std::abs(x);
                };
                box.low[k] = scale * near(low);
                box.high[k] = std::max(box.low[k], scale * near(high));
            }
        }
        QuantisedBoxes quantised;
        (void)quantised.set(boxes);
        expect_outward(quantised, boxes, std::to_string(i));
    }
}

// The extent is 255 steps, a few ulps less, or a few more: the last plane must still fit in a byte.
TEST(QuantisedBoxes, TheLastPlaneIsTheLastByte) {
    for (const int exponent : {-1074, -1030, -1015, -400, 0, 390}) {
        for (int ulps = -3; ulps <= 3; ++ulps) {
            double extent = std::ldexp(255.0, exponent);
            for (int u = 0; u < std::abs(ulps); ++u) extent = std::nextafter(extent, ulps < 0 ? 0.0 : 1e300);
            std::array<Box, 2> boxes;
            boxes[0] = {Vec3::Zero(), Vec3::Constant(extent)};
            boxes[1] = {Vec3::Constant(extent / 3), Vec3::Constant(extent / 2)};
            QuantisedBoxes quantised;
            const Box whole = quantised.set(boxes);
            EXPECT_EQ(whole.high, boxes[0].high);
            expect_outward(quantised, boxes, fmt::format("{} {}", exponent, ulps));
        }
    }
}

// The corner is 200.5 steps from the origin. Plane 200 would be rounded to the corner itself, but is inside before it
// is rounded.
TEST(QuantisedBoxes, PlanesAreNeverInsideBeforeTheyAreRounded) {
    std::array<Box, 1> boxes;
    boxes[0] = {Vec3::Constant(1 - 0x1p-53), Vec3::Constant(1 + 200 * 0x1p-52)};
    QuantisedBoxes quantised;
    (void)quantised.set(boxes);
    expect_outward(quantised, boxes, "halfway");
}

// A box of subnormal size beside one of size 2^400: its distance from the origin underflows when counted in steps.
TEST(QuantisedBoxes, ATinyBoxBesideAHugeOne) {
    std::array<Box, 2> boxes;
    boxes[0] = {Vec3::Zero(), Vec3::Constant(0x1p400)};
    boxes[1] = {Vec3::Zero(), Vec3::Constant(0x1p-1074)};
    QuantisedBoxes quantised;
    (void)quantised.set(boxes);
    expect_outward(quantised, boxes, "subnormal");
}

}  // namespace
}  // namespace hausbench
