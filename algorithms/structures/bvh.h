// A bounding volume hierarchy over triangles (triangle_tree.h), for closest point queries.
//
// It has up to eight children per node and up to eight triangles per leaf, and is built with the surface area
// heuristic (build_bvh in wide_tree.h).
#pragma once

#include "algorithms/structures/triangle_tree.h"

#include <string_view>

namespace hausbench {

class TriangleBvh : public TriangleTree {
public:
    static constexpr std::string_view structure_name = "BVH";
    static constexpr int structure_layout = 1;

    // `mesh` must outlive the tree. O(n log n) time, O(n) memory.
    explicit TriangleBvh(const TriangleMesh& mesh) : TriangleTree(mesh, build_bvh(mesh)) {}
};

}  // namespace hausbench
