// An octree over the triangles of a mesh, for closest point queries (triangle_tree.h).
#pragma once

#include "algorithms/structures/triangle_tree.h"

#include <string_view>

namespace hausbench {

// Each triangle belongs to the cell that contains the centre of its box. Cells with one child are skipped. A cell
// of up to eight triangles is a leaf, or shares one with small cells beside it; a cell of up to 64 is cut into as
// many leaves as it fills. Every cell stores the tight box of the triangles below it.
class TriangleOctree : public TriangleTree {
public:
    static constexpr std::string_view structure_name = "octree";
    static constexpr int structure_layout = 1;

    // `mesh` must outlive this. O(n log n) time, O(n) memory; at most 100 levels, wherever the triangles lie.
    explicit TriangleOctree(const TriangleMesh& mesh) : TriangleTree(mesh, build_octree(mesh)) {}
};

}  // namespace hausbench
