// Triangle blocks must give the bits of a plain scan, on ordinary and hostile meshes, and gather all near triangles.
#include "algorithms/structures/triangle_blocks.h"

#include "algorithms/kernel/morton.h"
#include "tests/support/tree_meshes.h"

#include <algorithm>
#include <array>
#include <set>

#include <gtest/gtest.h>

#include <fmt/format.h>

namespace hausbench {
namespace {

void expect_same(const ClosestPoint& a, const ClosestPoint& b, const std::string& where) {
    EXPECT_EQ(a.squared_distance, b.squared_distance) << where;
    EXPECT_EQ(a.triangle, b.triangle) << where;
    EXPECT_EQ(a.point, b.point) << where;
}

void expect_same_as_scan(const TriangleMesh& mesh, Random& random, int queries, const std::string& name) {
    const TriangleBlocks blocks(mesh);
    Counters counters;
    for (int i = 0; i < queries; ++i) {
        const Vec3 point = query_near(mesh, random);
        const ClosestPoint expected = closest_by_scan(mesh, point, {}, counters);
        expect_same(blocks.closest(point, {}, counters), expected, name);
        ClosestHints warm;
        warm.warm_triangle =
            random.below(2) != 0 ? expected.triangle : random.below(static_cast<Index>(mesh.triangles.rows()));
        expect_same(blocks.closest(point, warm, counters), expected, name + ", warm");
        ClosestHints radius;
        radius.squared_radius = expected.squared_distance;
        expect_same(blocks.closest(point, radius, counters), expected, name + ", radius just large enough");
        radius.squared_radius = std::nextafter(expected.squared_distance, -1);
        EXPECT_EQ(blocks.closest(point, radius, counters).triangle, -1) << name;
        radius.warm_triangle = warm.warm_triangle;
        EXPECT_EQ(blocks.closest(point, radius, counters).triangle, -1) << name;

        const double certified = blocks.certified_distance(point, counters);
        EXPECT_GE(certified, certified_distance_by_scan(mesh, point, counters)) << name;
        EXPECT_LE(certified, std::sqrt(expected.squared_distance)) << name;
    }
}

TEST(TriangleBlocks, SameBitsAsAScanOn200Meshes) {
    Random random(4);
    for (const auto& [name, mesh] : tree_meshes())
        expect_same_as_scan(mesh, random, mesh.triangles.rows() > 1000 ? 100 : 200, name);
}

// So far from the origin, plain distances have larger rounding errors than the frames of a leaf.
TEST(TriangleBlocks, SameBitsAsAScanFarFromTheOrigin) {
    Random random(6);
    for (const double away : {1e10, 1e12, 1e13, 1e14}) {
        TriangleMesh mesh = triangle_soup(random, 300, 0.3);
        mesh.vertices.array() += away;
        expect_same_as_scan(mesh, random, 300, fmt::format("{} away", away));
    }
}

// The points are too far away for single precision. They are offset along an axis: from a slanted direction, slightly
// farther triangles could not be told apart.
TEST(TriangleBlocks, SameBitsAsAScanFromVeryFarAway) {
    Random random(7);
    Counters counters;
    const TriangleMesh mesh = triangle_grid(random, 12, 0.5);
    const TriangleBlocks blocks(mesh);
    for (int exponent = 36; exponent < 60; ++exponent) {
        for (int k = 0; k < 3; ++k) {
            Vec3 point = mesh.vertices.row(random.below(144));
            point[k] += random.below(2) == 0 ? -std::ldexp(1.0, exponent) : std::ldexp(1.0, exponent);
            const ClosestPoint expected = closest_by_scan(mesh, point, {}, counters);
            expect_same(blocks.closest(point, {}, counters), expected, std::to_string(exponent));
            ClosestHints radius;
            radius.squared_radius = expected.squared_distance;
            expect_same(blocks.closest(point, radius, counters), expected, std::to_string(exponent) + ", radius");
        }
    }
}

TEST(TriangleBlocks, EarlyOutStopsAtATriangleNearEnough) {
    Random random(5);
    const TriangleMesh mesh = triangle_soup(random, 2000, 0.1);
    const TriangleBlocks blocks(mesh);
    Counters full, early;
    for (int i = 0; i < 300; ++i) {
        const Vec3 point = random.vector();
        ClosestHints hints;
        hints.early_out_squared = 0.01;
        const double nearest = blocks.closest(point, {}, full).squared_distance;
        const ClosestPoint answer = blocks.closest(point, hints, early);
        EXPECT_GE(answer.squared_distance, nearest);
        EXPECT_TRUE(nearest <= 0.01 ? answer.squared_distance <= 0.01 : answer.squared_distance == nearest);
    }
    EXPECT_LT(early.node_visits, full.node_visits);
}

// A stray triangle far away must not make a query search everything.
TEST(TriangleBlocks, WorkDoesNotGrowWithTheRatioOfScales) {
    Counters tame;
    for (const double ratio : {1.0, 10.0, 1e3, 1e6, 1e9, 1e12}) {
        Random random(11);
        TriangleMesh mesh = triangle_grid(random, 40, 0.05);
        const TriangleMesh cluster = mesh;
        if (ratio > 1) {
            const auto vertices = static_cast<Index>(mesh.vertices.rows()),
                       triangles = static_cast<Index>(mesh.triangles.rows());
            mesh.vertices.conservativeResize(vertices + 3, 3);
            mesh.triangles.conservativeResize(triangles + 1, 3);
            for (int k = 0; k < 3; ++k) {
                mesh.vertices.row(vertices + k) =
                    Vec3(cluster.vertices.row(k)) + Vec3(5 * ratio, 3 * ratio, -4 * ratio);
                mesh.triangles(triangles, k) = vertices + k;
            }
        }
        const TriangleBlocks blocks(mesh);
        Counters counters, scanned;
        for (int i = 0; i < 300; ++i) {
            const Vec3 point = Vec3(cluster.vertices.row(random.below(1600))) + random.vector(0.1);
            const ClosestPoint answer = blocks.closest(point, {}, counters);
            if (i % 30 == 0)
                expect_same(answer, closest_by_scan(mesh, point, {}, scanned), fmt::format("ratio {}", ratio));
        }
        if (ratio == 1) tame = counters;
        // Allows for one level of the tree that covers both scales and separates nothing within the small one.
        EXPECT_LE(counters.node_visits, 8 * tame.node_visits) << ratio;
        EXPECT_LE(counters.point_triangle_distances, 2 * tame.point_triangle_distances) << ratio;
    }
}

// Returns whether a triangle in `of` has the same corners as `t`, in the same order.
bool is_copy(const TriangleMesh& mesh, Index t, const std::set<Index>& of) {
    return std::any_of(of.begin(), of.end(), [&](Index i) {
        const Triangle x = triangle_of(mesh, t), y = triangle_of(mesh, i);
        return x.a == y.a && x.b == y.b && x.c == y.c;
    });
}

// Only one of several equal triangles must be gathered.
TEST(TriangleBlocks, CopiesAreLeftOut) {
    Random random(15);
    TriangleMesh mesh = triangle_grid(random, 6, 0.05);
    const TriangleMesh once = mesh;
    const Index triangles = static_cast<Index>(mesh.triangles.rows());
    mesh.triangles.conservativeResize(50 * triangles, 3);
    for (Index i = triangles; i < mesh.triangles.rows(); ++i) mesh.triangles.row(i) = once.triangles.row(i % triangles);
    const TriangleBlocks blocks(mesh);
    NearTriangles<float> near;
    LocalUnits units;
    Box box;
    box.add(Vec3(-1, -1, -1));
    box.add(Vec3(2, 2, 2));
    units.set(box, 1e-30);
    near.clear(units);
    Counters counters;
    blocks.gather(Vec3(0.5, 0.5, 0), 100, near, counters);
    EXPECT_EQ(near.count(), static_cast<std::size_t>(triangles));
    for (const Index i : near.triangle) EXPECT_LT(i, triangles);
}

// Every triangle within the radius must be gathered, unless there are too many, and none that is clearly farther.
// Distances from the gathered frames must be within near_error.
TEST(TriangleBlocks, GatherWhatIsNear) {
    Random random(12);
    int complete = 0, cut_short = 0;
    for (const auto& [name, mesh] : tree_meshes()) {
        const double size = mesh.vertices.cwiseAbs().maxCoeff();
        if (!(size > 1e-300 && size < 1e100)) continue;
        const TriangleBlocks blocks(mesh);
        NearTriangles<float> near;
        NearTriangles<double> exactly;
        for (int i = 0; i < 20; ++i) {
            const Vec3 centre = query_near(mesh, random);
            if (centre.cwiseAbs().maxCoeff() > 4 * size) continue;
            const double radius = size * std::pow(10, random.real(-4, 0));
            Box box;
            box.add(Vec3(centre.array() - 0.3 * radius));
            box.add(Vec3(centre.array() + 0.3 * radius));
            LocalUnits units;
            units.set(box, size * 0x1p-100);
            near.clear(units);
            Counters counters;
            blocks.gather(centre, radius, near, counters);
            const std::set<Index> gathered(near.triangle.begin(), near.triangle.end());
            EXPECT_EQ(gathered.size(), near.count()) << name;
            const bool all = near.count() <= near.most;
            complete += all;
            cut_short += !all;
            for (Index t = 0; t < mesh.triangles.rows(); ++t) {
                const double distance = std::sqrt(closest_point(centre, triangle_of(mesh, t)).squared_distance);
                if (distance <= radius * (1 - 1e-12)) {
                    EXPECT_TRUE(!all || gathered.contains(t) || is_copy(mesh, t, gathered)) << name;
                } else if (distance > radius + 1e-3 * (radius + 3 * size)) {
                    EXPECT_FALSE(gathered.contains(t)) << name;
                }
            }
            if (gathered.empty()) continue;
            exactly.clear(units);
            set_frames(mesh, near.triangle, exactly);
            ASSERT_EQ(exactly.triangle, near.triangle);
            for (std::size_t k = 0; k < near.count(); ++k) {
                const Vec3 point = centre + 0.2 * random.vector(radius);
                Vec3 local;
                for (int j = 0; j < 3; ++j) local[j] = (point[j] - units.origin[j]) * units.inverse;
                const double expected =
                    std::sqrt(closest_point(point, triangle_of(mesh, near.triangle[k])).squared_distance) *
                    units.inverse;
                const auto distance = [&, &scene_name = name]<class T>(const NearTriangles<T>& frames) {
                    TriangleFrames<T> copies;
                    for (std::size_t r = 0; r < frame_row::count; ++r)
                        std::fill_n(copies.row[r], frames_width, frames.row(r)[k]);
                    const T p[3] = {static_cast<T>(local[0]), static_cast<T>(local[1]), static_cast<T>(local[2])};
                    T squared[frames_width];
                    squared_distances(copies, p, squared);
                    const double error = near_error<T> * frame_roundoff<T> *
                                             (local.norm() + static_cast<double>(frames.row(frame_row::count)[k])) +
                                         64 * 0x1p-53 * size * units.inverse + frame_underflow<T>;
                    EXPECT_NEAR(std::sqrt(static_cast<double>(squared[0])), expected, error) << scene_name;
                };
                distance(near);
                distance(exactly);
            }
        }
    }
    EXPECT_GT(complete, 100);
    EXPECT_GT(cut_short, 10);
}

// Enough triangles for several blocks of work; runs mix scales and copies.
TEST(TriangleBlocks, AreTheSameForAnyNumberOfThreads) {
    Random random(16);
    TriangleMesh mesh = triangle_soup(random, 20000, 0.001);
    for (Index t = 0; t < 20000; t += 40) {
        for (int k = 0; k < 3; ++k) mesh.vertices.row(3 * t + k) += random.vector(20);
        if (t > 0) mesh.triangles.row(t + 1) = mesh.triangles.row(t + 2);
    }
    const std::vector<Index> order = TriangleOrder(mesh).order;
    const TriangleBlocks alone(mesh);
    EXPECT_GT(alone.leaves().size(), 19501U / frames_width);  // some runs were cut
    for (const int threads : {2, 5}) {
        EXPECT_EQ(TriangleOrder(mesh, Threads(threads)).order, order);
        const TriangleBlocks blocks(mesh, Threads(threads));
        ASSERT_EQ(blocks.leaves().size(), alone.leaves().size());
        for (std::size_t i = 0; i < blocks.leaves().size(); ++i) {
            const TriangleFramesLeaf &x = blocks.leaves()[i], &y = alone.leaves()[i];
            ASSERT_EQ(x.count, y.count) << i;
            ASSERT_EQ(std::memcmp(x.triangle, y.triangle, sizeof x.triangle), 0) << i;
            ASSERT_EQ(std::memcmp(x.frames.row, y.frames.row, sizeof x.frames.row), 0) << i;
            ASSERT_EQ(std::memcmp(x.units.origin, y.units.origin, sizeof x.units.origin), 0) << i;
            ASSERT_EQ(x.units.unit, y.units.unit) << i;
        }
    }
}

TEST(TriangleBlocks, TakeFewBytes) {
    Random random(14);
    const TriangleMesh mesh = triangle_grid(random, 100, 0.05);
    EXPECT_LE(TriangleBlocks(mesh).bytes(), 95 * static_cast<std::size_t>(mesh.triangles.rows()));
}

// Every run of sixteen triangles mixes scales, so each could need two leaves.
TEST(TriangleBlocks, TakeFewBytesWhereScalesAreMixed) {
    Random random(15);
    TriangleMesh mesh = triangle_soup(random, 8000, 0.001);
    for (Index t = 0; t < 8000; t += 8) {
        for (int k = 0; k < 3; ++k) mesh.vertices.row(3 * t + k) += random.vector(20);
    }
    const TriangleBlocks blocks(mesh);
    EXPECT_LE(blocks.bytes(), 100 * 8000U);
    EXPECT_GT(blocks.leaves().size(), 8000U / frames_width);  // some runs were cut
}

// Consecutive cells of the curve must be neighbours, and each cell must occur once.
TEST(Hilbert, IsACurveThroughAllCells) {
    constexpr std::uint32_t side = 32, cells = side * side * side;
    std::vector<std::array<std::uint32_t, 3>> cell(cells);
    std::vector<int> visits(cells);
    for (std::uint32_t x = 0; x < side; ++x) {
        for (std::uint32_t y = 0; y < side; ++y) {
            for (std::uint32_t z = 0; z < side; ++z) {
                std::uint32_t key = 0;  // key of a cell 2^5 times as wide, at its lower corner
                for (int bit = 4; bit >= 0; --bit)
                    key = key << 3 | (x >> bit & 1) << 2 | (y >> bit & 1) << 1 | (z >> bit & 1);
                const std::uint32_t place = hilbert_key(key << 15) >> 15;
                ASSERT_LT(place, cells);
                cell[place] = {x, y, z};
                ++visits[place];
            }
        }
    }
    for (std::uint32_t i = 0; i < cells; ++i) {
        ASSERT_EQ(visits[i], 1) << i;
        if (i == 0) continue;
        std::uint32_t steps = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            steps += std::max(cell[i][k], cell[i - 1][k]) - std::min(cell[i][k], cell[i - 1][k]);
        }
        ASSERT_EQ(steps, 1u) << i;
    }
}

}  // namespace
}  // namespace hausbench
