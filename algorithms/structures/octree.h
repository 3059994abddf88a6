// An octree over the triangles of a mesh, for closest point queries (triangle_tree.h).
#pragma once

#include "algorithms/structures/triangle_tree.h"

#include <string_view>

namespace hausbench {

// Each triangle belongs to the cell that contains the centre of its box. A cell that has triangles in only one of its
// eight octants is skipped: that octant takes its place in the tree. Small octants of the same cell share a leaf, up
// to eight triangles. A cell of up to 64 triangles is not cut into octants, but into as few leaves as can hold its
// triangles. Queries do not look at cells: each node stores the boxes around the triangles of its children.
class TriangleOctree : public TriangleTree {
public:
    static constexpr std::string_view structure_name = "octree";
    static constexpr int structure_layout = 1;

    // `mesh` must outlive the tree. O(n log n) time, O(n) memory; at most 100 levels, wherever the triangles lie.
    explicit TriangleOctree(const TriangleMesh& mesh) : TriangleTree(mesh, build_octree(mesh)) {}
};

}  // namespace hausbench
