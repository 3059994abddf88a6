// One leaf of a TriangleTree: up to eight triangles, with quantised boxes. Their corners refer to a table of vertices,
// because most vertices belong to several triangles.
#pragma once

#include "algorithms/kernel/point_triangle.h"
#include "algorithms/structures/wide_tree.h"

#include <cstdint>
#include <span>

namespace hausbench {

struct alignas(64) TriangleLeaf {
    QuantisedBoxes boxes;  // of the triangles
    // corner[v][i] is three times the index, among the vertices of this leaf, of corner v of triangle i: the offset of
    // its first coordinate. Corners 0 and 1 are the ends of the longest edge. Unused lanes repeat triangle 0.
    std::uint8_t corner[3][leaf_capacity];
    std::uint32_t first_vertex;  // index of this leaf's first vertex among the vertices of all leaves
    std::int32_t first;          // index in WideTree::order of triangle 0
    std::int32_t count;          // number of triangles

    // Stores one to eight triangles of a mesh. Writes each of their vertices once to `vertices`, from index 3 * next
    // on, and increases `next` by the number of vertices. Returns the exact box around the triangles.
    Box set(const TriangleMesh& mesh, std::span<const Index> triangles, double* vertices, std::uint32_t& next);

    // Returns triangle `lane`, with the longest edge first; `vertices` are the vertices of all leaves.
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
