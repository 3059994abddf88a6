// An octree over the triangles of a mesh, for closest point queries (triangle_tree.h).
#pragma once

#include "algorithms/structures/triangle_tree.h"

#include <string_view>

namespace hausbench {

// An octree whose cells only decide which triangles share a node: a triangle belongs to the cell that contains the
// centre of its box. Queries use the boxes around the triangles of each child instead. build_octree() in wide_tree.h
// says when cells are skipped or share a leaf.
class TriangleOctree : public TriangleTree {
public:
    static constexpr std::string_view structure_name = "octree";
    static constexpr int structure_layout = 1;

    // `mesh` must outlive the tree. O(n log n) time, O(n) memory; at most 100 levels, wherever the triangles lie.
    explicit TriangleOctree(const TriangleMesh& mesh) : TriangleTree(mesh, build_octree(mesh)) {}
};

}  // namespace hausbench
