// The common part of the BVH builder (bvh.cpp) and the octree builder (octree.cpp). Not for use elsewhere.
//
// An *element* is a triangle, represented by its box. All elements are in one array, and every node of the tree is
// built over a *range* of it: the range is divided into parts, one for each child. The two builders differ only in how
// they divide a range.
//
// They decide by boxes in single precision, because four floats fit into one register. If the elements of a range are
// so close together that single precision hardly tells them apart, their boxes are computed again, in coordinates
// relative to this range (Builder::localise). All these boxes may be inexact: they decide only the shape of the tree.
// The boxes that the tree stores are set afterwards, from exact ones (WideTree::fit).
#pragma once

#include "algorithms/kernel/parallel.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/structures/wide_tree.h"

#include <array>
#include <bit>
#include <limits>
#include <utility>

namespace hausbench::builder {

// Four floats, which x86-64 processors add or compare with one instruction. On machines without vector registers, the
// compiler emits scalar code.
using Float4 [[gnu::vector_size(16)]] = float;

// A box in single precision. The first three components of `low` and `high` are coordinates. The fourth component of
// `low` may hold the index of a triangle (see set_number).
struct FloatBox {
    Float4 low = Float4{} + std::numeric_limits<float>::infinity(),
           high = Float4{} - std::numeric_limits<float>::infinity();

    void add(Float4 point) {
        low = point < low ? point : low;
        high = point > high ? point : high;
    }
    void add(const FloatBox& box) {
        low = box.low < low ? box.low : low;
        high = box.high > high ? box.high : high;
    }
};

// Maps points to single precision, as (x - centre) * scale, so that the box given to of() lands inside [-1, 1]^3.
struct LocalFrame {
    Vec3 centre = Vec3::Zero();
    double scale = 1;  // a power of two

    static LocalFrame of(const Box& box);

    // Returns the mapped point. Clamps its coordinates to [-2^40, 2^40] so that areas do not overflow. Coordinates are
    // large if of() was given the box around the centres of triangles and a triangle is far larger than this box.
    Float4 local(const Vec3& p) const {
        Float4 result{};
        for (int k = 0; k < 3; ++k) {
            result[k] = static_cast<float>(std::min(std::max((p[k] - centre[k]) * scale, -0x1p40), 0x1p40));
        }
        return result;
    }
};

// Returns half the surface area.
inline float area(const FloatBox& box) {
    const Float4 d = box.high - box.low;
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
}

// Stores the index of a triangle in the bits of low[3]. Without the added 0x40000000, these bits could be a subnormal
// float, which slows down operations on the whole vector.
inline void set_number(FloatBox& element, Index number) { element.low[3] = std::bit_cast<float>(number + 0x40000000); }
inline Index number_of(const FloatBox& element) {
    return std::bit_cast<Index>(static_cast<float>(element.low[3])) - 0x40000000;
}
// Returns twice the centre of a box; the factor does not matter for comparisons.
inline Float4 centre_of(const FloatBox& element) { return element.low + element.high; }

// A part whose centres spread over less than this fraction of the node's spread is not divided further here. It becomes
// one child and is divided as a node of its own, because the coordinates and the quantised boxes of the larger node are
// too coarse for it.
inline constexpr float finest_part = 0x1p-5F;

// The elements from index `begin` to `end` - 1, the box around them, and the box around their doubled centres
// (centre_of).
struct Range {
    std::int32_t begin = 0, end = 0;
    FloatBox box, centres;

    std::int32_t size() const { return end - begin; }

    // Returns the longest side of the box around the centres, not doubled.
    float spread() const {
        const Float4 d = centres.high - centres.low;
        return 0.5F * std::max(std::max(d[0], d[1]), d[2]);
    }
};

// Builds the shape of a tree: its nodes, its leaves and the order of the triangles, but no boxes.
struct Builder {
    const TriangleMesh& mesh;
    std::vector<FloatBox> elements;
    WideTree tree;
    std::array<FloatBox, tree_width * leaf_capacity> scratch;  // for put_in_order()

    explicit Builder(const TriangleMesh& mesh);

    Range range(std::int32_t begin, std::int32_t end) const {
        Range result{begin, end, {}, {}};
        for (std::int32_t i = begin; i < end; ++i) {
            const FloatBox& element = elements[static_cast<std::size_t>(i)];
            result.box.add(element);
            result.centres.add(centre_of(element));
        }
        return result;
    }

    // If the centres of a range lie so close together that single precision hardly tells them apart, computes the boxes
    // of its elements again, relative to these centres. This takes O(size) and makes coordinates finer by a factor of
    // at least 2^12.
    void localise(Range& range);

    // Reorders a range of at most 64 elements, so that along its longest axis the elements before index `middle` have
    // smaller centres than the elements from `middle` on. Neither side is sorted.
    void put_in_order(const Range& range, std::int32_t middle);

    // Appends a leaf. Returns ~(leaf number), as it is stored in WideNode::child.
    std::int32_t add_leaf(const Range& range) {
        // Queries compute the distances of four triangles at a time, so neighbours should be in the same half of a
        // leaf.
        constexpr std::int32_t half = leaf_capacity / 2;
        if (range.size() > half) put_in_order(range, range.begin + half);
        for (std::int32_t i = range.begin; i < range.end; ++i) {
            tree.order.push_back(number_of(elements[static_cast<std::size_t>(i)]));
        }
        tree.leaf_begin.push_back(static_cast<std::int32_t>(tree.order.size()));
        return ~static_cast<std::int32_t>(tree.leaves() - 1);
    }

    // Builds the tree. For each node that is too large for a leaf, split(range, depth, parts) must divide its range
    // into two to eight parts, write them to `parts` and return their number; parts[0] is the whole range before the
    // call.
    template <class Split> WideTree build(Split&& split) {
        add_node(range(0, static_cast<std::int32_t>(elements.size())), 0, split);
        tree.nodes.shrink_to_fit();
        tree.leaf_begin.shrink_to_fit();
        return std::move(tree);
    }

    template <class Split> std::int32_t add_node(Range whole, int depth, Split&& split) {
        std::array<Range, tree_width> parts;
        int count = 1;
        if (whole.size() > leaf_capacity) {
            if (WATCHED("trees: large ones cannot be stopped", whole.size() > 4096)) Stoppable::look();
            localise(whole);
            parts[0] = whole;
            count = split(whole, depth, parts);
        } else {
            parts[0] = whole;
        }

        const std::size_t at = tree.nodes.size();
        tree.nodes.emplace_back();
        tree.nodes[at].count = count;
        for (int c = 0; c < count; ++c) {
            const Range& part = parts[static_cast<std::size_t>(c)];
            const std::int32_t child = part.size() <= leaf_capacity ? add_leaf(part) : add_node(part, depth + 1, split);
            tree.nodes[at].child[c] = child;
        }
        return static_cast<std::int32_t>(at);
    }
};

// Divides a range, in its present order, into eight parts of about equal size. Makes fewer parts if fewer leaves can
// hold all elements.
inline int split_evenly(const Builder& builder, const Range& whole, std::array<Range, tree_width>& parts) {
    const std::int32_t leaves = (whole.size() + leaf_capacity - 1) / leaf_capacity;
    const std::int32_t count = std::min<std::int32_t>(leaves, tree_width);
    const std::int32_t size = (whole.size() + count - 1) / count;
    int made = 0;
    for (std::int32_t begin = whole.begin; begin < whole.end; begin += size) {
        parts[static_cast<std::size_t>(made++)] = builder.range(begin, std::min(begin + size, whole.end));
    }
    return made;
}

}  // namespace hausbench::builder
