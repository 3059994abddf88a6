// A tree of boxes with up to eight children per node: the common part of the BVH and the octree. Nodes store the boxes
// of their children quantised (quantised_boxes.h). The elements of the tree are the triangles of a mesh.
#pragma once

#include "algorithms/kernel/geometry.h"
#include "algorithms/structures/quantised_boxes.h"

#include <cstdint>
#include <span>
#include <vector>

namespace hausbench {

inline constexpr int leaf_capacity = 8;  // elements per leaf
inline constexpr int most_tree_levels = 100;

struct alignas(64) WideNode {
    QuantisedBoxes boxes;            // of the children
    std::int32_t child[tree_width];  // >= 0: a node number; negative: ~(leaf number)
    std::int32_t count;              // number of children
};
static_assert(sizeof(WideNode) == 128);

struct WideTree {
    std::vector<WideNode> nodes;  // parents before children; the root is node 0
    // The elements of leaf i are order[j] for leaf_begin[i] <= j < leaf_begin[i + 1].
    std::vector<std::int32_t> leaf_begin;
    std::vector<Index> order;  // the index of each element, once

    std::size_t leaves() const { return leaf_begin.size() - 1; }
    std::span<const Index> leaf(std::size_t i) const {
        return {order.data() + leaf_begin[i], static_cast<std::size_t>(leaf_begin[i + 1] - leaf_begin[i])};
    }
    std::size_t bytes() const {
        return nodes.capacity() * sizeof(WideNode) + leaf_begin.capacity() * sizeof(std::int32_t) +
               order.capacity() * sizeof(Index);
    }

    // Computes the boxes of all nodes from the exact boxes of the leaves. Call it after building the tree or moving
    // elements. O(n).
    void fit(std::span<const Box> leaf_boxes);
};

// Builds a BVH over at least one triangle, but only its shape; fit() sets its boxes.
//
// Built top-down. A set of triangles is cut in two by the surface area heuristic with up to 16 bins along an axis
// (Wald, On fast construction of SAH-based bounding volume hierarchies, 2007). The cost of each side of a cut is the
// area of its box times the number of leaves that its triangles fill. Sets of more than 1024 triangles are cut only
// along their longest axis. Repeated cuts of the part with the largest box make up to eight children of a node; parts
// far smaller than the node are not cut further. O(n log n) time, O(n) memory.
WideTree build_bvh(const TriangleMesh& mesh);

// Builds an octree over at least one triangle, but only its shape; fit() sets its boxes.
//
// Each element belongs to the cell that contains the centre of its box. A cell that has elements in only one of its
// octants is skipped: that octant takes its place. Small octants of the same cell share a leaf, up to eight elements.
// A cell of up to 64 elements is not cut into octants, but halved repeatedly, across the longest axis, into as few
// leaves as can hold them. If the centres in a cell spread over less than 2^-13 of the side of the root cell, a new
// octree begins with a root cell around these centres. Elements whose centres cannot be told apart, and all elements
// from level 48 of the tree on, are divided into parts of equal size instead.
WideTree build_octree(const TriangleMesh& mesh);

}  // namespace hausbench
