// A tree of boxes with up to eight children a node: what the BVH and the octree have in common.
//
// A node knows its own box in double precision, and those of its children by one byte a plane, in steps of a power of two
// from its own lower corner, rounded outward. So every level has a precision of its own: a stray triangle far away makes
// the boxes beside it coarse, and none below them.
//
// The distance to a box never exceeds the computed squared distance to a point of its content, so that no slack is needed
// elsewhere. Near a node, distances are integers, in parts of its step, rounded down (measure_boxes in wide_walk-inl.h). Far
// from it, they are computed by the operations of squared_distance_to_box (box.h), which are monotone, to planes that are
// what origin + q step is when computed: no farther inside than any coordinate of the content (QuantisedBoxes::set).
#pragma once

#include "kernel/box.h"

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace hausbench {

inline constexpr int tree_width = 8;     // children of a node
inline constexpr int leaf_capacity = 8;  // elements of a leaf
inline constexpr int most_tree_levels = 100;

// Boxes around up to eight boxes, a byte a plane.
struct QuantisedBoxes {
    double origin[3];  // the lower corner of all of them
    double step;       // a power of two from 2^-440 to 2^394
    double inverse;    // of the step
    // Those of x and y side by side, as wide_walk-inl.h multiplies them.
    std::uint8_t low_xy[tree_width][2], low_z[tree_width], high_xy[tree_width][2], high_z[tree_width];

    std::uint8_t& low(int k, std::size_t i) { return k < 2 ? low_xy[i][k] : low_z[i]; }
    std::uint8_t& high(int k, std::size_t i) { return k < 2 ? high_xy[i][k] : high_z[i]; }

    // As computed: q step is exact, the sum is rounded.
    double plane(int k, std::uint8_t q) const { return origin[k] + q * step; }

    // That of child i, by its planes as computed: it holds the content of the child.
    Box box(int i) const {
        return {{plane(0, low_xy[i][0]), plane(1, low_xy[i][1]), plane(2, low_z[i])},
                {plane(0, high_xy[i][0]), plane(1, high_xy[i][1]), plane(2, high_z[i])}};
    }

    // plane(k, low(k, i)) <= boxes[i].low[k] and boxes[i].high[k] <= plane(k, high(k, i)). Not as computed but in real
    // numbers, origin + (q -+ 2^-45) step is no farther inside either. What is not in use repeats the first. One to eight
    // boxes; coordinates up to 2^400. Returns the box around all of them, exactly.
    Box set(std::span<const Box> boxes);
};

struct alignas(64) WideNode {
    QuantisedBoxes boxes;            // of the children
    std::int32_t child[tree_width];  // >= 0: a node; negative: ~ the number of a leaf
    std::int32_t count;              // children
};
static_assert(sizeof(WideNode) == 128);

struct WideTree {
    std::vector<WideNode> nodes;           // parents before children; the root is node 0
    std::vector<std::int32_t> leaf_begin;  // leaf i holds order[leaf_begin[i]] to order[leaf_begin[i + 1] - 1]
    std::vector<Index> order;              // each element once

    std::size_t leaves() const { return leaf_begin.size() - 1; }
    std::span<const Index> leaf(std::size_t i) const {
        return {order.data() + leaf_begin[i], static_cast<std::size_t>(leaf_begin[i + 1] - leaf_begin[i])};
    }
    std::size_t bytes() const {
        return nodes.capacity() * sizeof(WideNode) + leaf_begin.capacity() * sizeof(std::int32_t) +
               order.capacity() * sizeof(Index);
    }

    // Sets the boxes of all nodes from those of the leaves, which are exact. Also after elements have moved; the shape of
    // the tree stays. O(n).
    void fit(std::span<const Box> leaf_boxes);
};

// What a tree is built over: points, or triangles whose corners they are.
struct TreeContent {
    const Points& points;
    const Triangles* triangles = nullptr;

    Index count() const { return static_cast<Index>(triangles != nullptr ? triangles->rows() : points.rows()); }
    Box box(Index element) const;
};

// The shape of a tree; its boxes are set by fit(). At least one element.
//
// Top-down, by the surface area heuristic over 16 bins along each axis (Wald, On fast construction of SAH-based bounding
// volume hierarchies, 2007), the cost of a side being the blocks it fills; collapsed to eight children by always
// opening the child of largest area that is not far smaller than the node. O(n log n) time, O(n) memory.
WideTree build_bvh(const TreeContent& content);

// An octree: each element belongs to the cell that the centre of its box falls into. Cells with one child are passed over. A
// cell of up to eight elements is a leaf, or shares one with small cells beside it. One of up to 64 is cut into as many
// leaves as it fills, in halves across the longest axis. Where all centres of a cell lie in a
// 2^-12th of the root's cube, another octree begins, in the cube around them. Elements whose centres cannot be told apart,
// and those at level 48 of the tree, are cut into as many leaves as they fill.
WideTree build_octree(const TreeContent& content);

}  // namespace hausbench
