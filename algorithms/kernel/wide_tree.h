// A tree of boxes with up to eight children a node: what the BVH and the octree have in common.
//
// Boxes are in single precision, in a frame of their own (LocalFrame) and rounded outward, so that a node is 256 bytes and
// one or two vector operations measure all its children. A box distance in single precision, compared with
// float_bound(), never leaves out a box that holds a point whose computed double distance could win: no slack is needed
// elsewhere, and answers do not depend on the shape of the tree.
#pragma once

#include "box.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace hausbench {

inline constexpr int tree_width = 8;     // children of a node
inline constexpr int leaf_capacity = 8;  // elements of a leaf: one block (triangle_block.h)
inline constexpr int most_tree_levels = 100;

// Single precision coordinates (x - centre) 2^exponent, chosen so that the content of a tree lies in [-1, 1].
//
// What is lost: x - centre errs by u|x - centre| (for x in the tree, u the double unit), the conversion by 2^-24 of the
// result or, where it underflows, 2^-150. Widened by 2^-22 of itself and 2^-100, an interval holds the exact value.
struct LocalFrame {
    Vec3 centre = Vec3::Zero();
    double scale = 1;  // a power of two, at most 2^440

    static LocalFrame of(const Box& box);

    // Lowest and highest single precision value that p[k] may have here. Points far outside are taken to be at 2^60, which
    // is no farther from any box of the tree.
    template <class Float> void interval(const Vec3& p, int k, Float&& low, Float&& high) const {
        const double local = std::min(std::max((p[k] - centre[k]) * scale, -0x1p60), 0x1p60);
        const float nearest = static_cast<float>(local);
        const float slack = std::abs(nearest) * 0x1p-22F + 0x1p-100F;
        low = nearest - slack;
        high = nearest + slack;
    }

    // A box whose single precision squared distance exceeds this holds no point at computed squared distance <= `squared`.
    // With intervals rounded outward, three squares and two sums in single precision exceed the exact ones by less than
    // 2^-21, or 2^-147 where they underflow. The computed double distance to a point of the box is at least (1 - 5u) times
    // the exact one, and 2^-1072 where it underflows, at most 2^-192 here.
    float float_bound(double squared) const {
        return static_cast<float>(std::min(squared * scale * scale * (1 + 0x1p-19), 0x1p127)) + 0x1p-126F;
    }
};

struct alignas(64) WideNode {
    float low[3][tree_width], high[3][tree_width];
    std::int32_t child[tree_width];  // >= 0: a node; negative: ~ the number of a leaf
    std::int32_t count;              // children
};

struct WideTree {
    LocalFrame frame;
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
};

// Four numbers at once, on every x86-64 processor and where there are no vectors too.
using Float4 [[gnu::vector_size(16)]] = float;

// A box in single precision; the fourth numbers are for the builder.
struct FloatBox {
    Float4 low = Float4{} + std::numeric_limits<float>::infinity(),
           high = Float4{} - std::numeric_limits<float>::infinity();

    void add(Float4 point) { low = point < low ? point : low, high = point > high ? point : high; }
    void add(const FloatBox& box) { low = box.low < low ? box.low : low, high = box.high > high ? box.high : high; }
};

// Boxes of elements, in the frame of their union.
struct LocalBoxes {
    LocalFrame frame;
    std::vector<FloatBox> boxes;
};
LocalBoxes local_boxes(const TriangleMesh& mesh);
LocalBoxes local_boxes(const Points& points);

// Top-down, by the surface area heuristic over 16 bins along each axis (Wald, On fast construction of SAH-based bounding
// volume hierarchies, 2007), the cost of a side being the blocks it fills; collapsed to eight children by always
// opening the child of largest area. O(n log n) time, O(n) memory. At least one element.
WideTree build_bvh(LocalBoxes&& boxes);

// An octree: each element belongs to the cell that the centre of its box falls into; cells with one child are passed
// over; a cell of up to eight elements is a leaf, and so is one at level 48, cut into as many leaves as it fills.
WideTree build_octree(LocalBoxes&& boxes);

// Makes the boxes fit elements that have moved; the shape of the tree stays. O(n).
void refit(WideTree& tree, const LocalBoxes& boxes);

}  // namespace hausbench
