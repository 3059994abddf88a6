// Eight triangles side by side, for kernels that process them together.
#pragma once

#include "algorithms/kernel/point_triangle.h"

#include <cstdint>
#include <span>

namespace hausbench {

inline constexpr int block_width = 8;  // logical width, the same on every machine

struct alignas(64) TriangleBlock {
    double corner[3][3][block_width];  // [corner][coordinate][lane], the longest edge first
    Index triangle[block_width];
    std::int32_t count;  // lanes in use; the other lanes repeat the first

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

// Eight points side by side.
struct alignas(64) PointBlock {
    double coordinate[3][block_width];
};

// For each lane, the same bits as closest_point(point, triangle).
struct alignas(64) BlockFeet {
    double squared_distance[block_width];
    double point[3][block_width];
};

// Tests one point against the triangles of a block.
void closest_points(const Vec3& point, const TriangleBlock& block, BlockFeet& feet);

// Tests the points of a block against one triangle.
void closest_points(const PointBlock& points, const Triangle& triangle, BlockFeet& feet);

}  // namespace hausbench
