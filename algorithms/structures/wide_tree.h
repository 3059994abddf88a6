// A tree of boxes with up to eight children per node: the common part of the BVH and the octree. Nodes store the
// boxes of their children quantised (quantised_boxes.h).
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
    // Leaf i: order[leaf_begin[i]] to [leaf_begin[i + 1] - 1].
    std::vector<std::int32_t> leaf_begin;
    std::vector<Index> order;  // each element once

    std::size_t leaves() const { return leaf_begin.size() - 1; }
    std::span<const Index> leaf(std::size_t i) const {
        return {order.data() + leaf_begin[i], static_cast<std::size_t>(leaf_begin[i + 1] - leaf_begin[i])};
    }
    std::size_t bytes() const {
        return nodes.capacity() * sizeof(WideNode) + leaf_begin.capacity() * sizeof(std::int32_t) +
               order.capacity() * sizeof(Index);
    }

    // Sets the boxes of all nodes from the exact boxes of the leaves. Also used after elements have moved; the
    // shape of the tree stays. O(n).
    void fit(std::span<const Box> leaf_boxes);
};

// Builds the shape of a tree over at least one element; fit() sets its boxes.
//
// Top-down, by the surface area heuristic over 16 bins along each axis (Wald, On fast construction of SAH-based
// bounding volume hierarchies, 2007), where the cost of a side counts the blocks that it fills. The tree is
// collapsed to eight children by always opening the child of largest area that is not far smaller than the node.
// O(n log n) time, O(n) memory.
WideTree build_bvh(const TriangleMesh& mesh);

// Builds the shape of an octree: each element belongs to the cell that contains the centre of its box. Cells with
// one child are skipped. A cell of up to eight elements is a leaf, or shares one with small cells beside it. A cell
// of up to 64 is cut into as many leaves as it fills, in halves across the longest axis. If all centres of a cell
// lie within a 2^-12th of the root's cube, another octree begins, in the cube around them. Elements whose centres
// cannot be told apart, and elements at level 48 of the tree, are cut into as many leaves as they fill.
WideTree build_octree(const TriangleMesh& mesh);

}  // namespace hausbench
