// The triangles of one leaf of a tree: their boxes with one byte per plane, and corners that they share.
#pragma once

#include "algorithms/kernel/point_triangle.h"
#include "algorithms/structures/wide_tree.h"

#include <cstdint>
#include <span>

namespace hausbench {

struct alignas(64) TriangleLeaf {
    QuantisedBoxes boxes;  // of the triangles
    // Three times the number of the corner in the leaf's own table of vertices, with the longest edge first. Unused
    // lanes repeat triangle 0.
    std::uint8_t corner[3][leaf_capacity];
    std::uint32_t first_vertex;  // where that table begins
    std::int32_t first;          // where its triangles begin in the order of the tree
    std::int32_t count;          // number of triangles

    // Sets the leaf to one to eight triangles. Appends their vertices at vertices[3 * next], each once, and moves
    // `next` behind them. Returns the exact box around the triangles.
    Box set(const TriangleMesh& mesh, std::span<const Index> triangles, double* vertices, std::uint32_t& next);

    Triangle at(int lane, const double* vertices) const {
        const auto vertex = [&](int v) {
            const double* place = vertices + 3 * std::size_t{first_vertex} + corner[v][lane];
            return Vec3(place[0], place[1], place[2]);
        };
        return {vertex(0), vertex(1), vertex(2)};
    }
};
static_assert(sizeof(TriangleLeaf) == 128);

// The leaves of a tree, and the arrays that they refer to.
struct TriangleLeaves {
    const TriangleLeaf* leaf;
    const double* vertices;
    const Index* order;  // triangle numbers
};

}  // namespace hausbench
