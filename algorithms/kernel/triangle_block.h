// Blocks of eight triangles or points, stored side by side for vector instructions, and their closest points.
#pragma once

#include "algorithms/kernel/point_triangle.h"

#include <cstdint>
#include <span>

namespace hausbench {

inline constexpr int block_width = 8;  // the same on every machine, whatever the width of its vectors

// One to eight triangles, one in each lane.
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

// A foot is the closest point of a triangle, as seen from a query point; here one in each lane. It has the same bits as
// closest_point(point, triangle).
struct alignas(64) BlockFeet {
    double squared_distance[block_width];
    double point[3][block_width];
};

// Finds the closest point of each triangle of the block to one point.
void closest_points(const Vec3& point, const TriangleBlock& block, BlockFeet& feet);

// Finds the closest point of one triangle to each point of the block.
void closest_points(const PointBlock& points, const Triangle& triangle, BlockFeet& feet);

}  // namespace hausbench
