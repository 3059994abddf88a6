// Blocks of eight triangles or points, laid out for vector instructions, and closest point queries on whole blocks.
#pragma once

#include "algorithms/kernel/point_triangle.h"

#include <cstdint>
#include <span>

namespace hausbench {

inline constexpr int block_width = 8;  // the same on every machine, whatever the width of its vectors

// One to eight triangles, one in each vector lane.
struct alignas(64) TriangleBlock {
    double corner[3][3][block_width];  // [corner][coordinate][lane]; corners 0 and 1 are the ends of the longest edge
    Index triangle[block_width];       // indices in the mesh
    std::int32_t count;                // lanes in use; the other lanes repeat lane 0

    void set(const TriangleMesh& mesh, std::span<const Index> triangles) {  // 1 to 8 triangles
        count = static_cast<std::int32_t>(triangles.size());
        for (std::size_t lane = 0; lane < block_width; ++lane) {
            triangle[lane] = triangles[lane < triangles.size() ? lane : 0];
            const Triangle t = longest_edge_first(triangle_of(mesh, triangle[lane]));
            for (int k = 0; k < 3; ++k) {
                corner[0][k][lane] = t.a[k];
                corner[1][k][lane] = t.b[k];
                corner[2][k][lane] = t.c[k];
            }
        }
    }

    Triangle at(int lane) const {
        const auto vertex = [&](int v) { return Vec3(corner[v][0][lane], corner[v][1][lane], corner[v][2][lane]); };
        return {vertex(0), vertex(1), vertex(2)};
    }
};

// Eight points, one in each lane.
struct alignas(64) PointBlock {
    double coordinate[3][block_width];
};

// The closest points of triangles to query points, one in each lane, with the same bits as closest_point()
// (point_triangle.h).
struct alignas(64) BlockFeet {
    double squared_distance[block_width];
    double point[3][block_width];
};

// Finds, for each triangle of a block, the point that is closest to `point`.
void closest_points(const Vec3& point, const TriangleBlock& block, BlockFeet& feet);

// Finds, for each point of a block, the closest point of `triangle`.
void closest_points(const PointBlock& points, const Triangle& triangle, BlockFeet& feet);

// The same for the first half of a block: lanes 0 to 3. The other lanes of `feet` are undefined; the other points must be
// finite.
void closest_points_of_half(const PointBlock& points, const Triangle& triangle, BlockFeet& feet);

}  // namespace hausbench
