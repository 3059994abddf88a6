// Octree over the triangles of a mesh, for closest point queries (triangle_tree.h).
#pragma once

#include "algorithms/structures/triangle_tree.h"

#include <string_view>

namespace hausbench {

// Each triangle belongs to the cell that the centre of its box falls into; cells with one child are passed over; a cell
// of up to eight triangles is a leaf, or shares one with small cells beside it; one of up to 64 is cut into as many leaves
// as it fills. Every cell knows the tight box of the triangles below it.
class TriangleOctree : public TriangleTree {
public:
    static constexpr std::string_view structure_name = "octree";
    static constexpr int structure_layout = 1;

    // `mesh` must outlive this. O(n log n) time, O(n) memory; at most 100 levels however the triangles lie.
    explicit TriangleOctree(const TriangleMesh& mesh) : TriangleTree(mesh, build_octree(mesh)) {}
};

}  // namespace hausbench
