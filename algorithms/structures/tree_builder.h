// The common part of the tree builders: elements with their boxes, ranges of elements, and nodes made of ranges.
// Not for use elsewhere.
//
// Builders decide by boxes in single precision, in a frame that becomes finer on the way down (Builder::localise).
// These boxes may be inexact, because the boxes of the tree are set afterwards, from exact ones.
#pragma once

#include "algorithms/structures/wide_tree.h"

#include <array>
#include <bit>
#include <limits>
#include <utility>

namespace hausbench::builder {

// Four floats at once, on every x86-64 processor, and on machines without vectors, too.
using Float4 [[gnu::vector_size(16)]] = float;

// A box in single precision; the fourth numbers are free for the builder.
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

// Single precision coordinates (x - centre) scale: a box becomes [-1, 1] or smaller.
struct LocalFrame {
    Vec3 centre = Vec3::Zero();
    double scale = 1;  // a power of two

    static LocalFrame of(const Box& box);

    // Coordinates far outside are clamped to 2^40, so that areas do not overflow.
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

// While a tree is built, the bits of the fourth number of `low` store the number of the element. Read as floats
// they are 2 or more, so never subnormal, which would be slow.
inline void set_number(FloatBox& element, Index number) { element.low[3] = std::bit_cast<float>(number + 0x40000000); }
inline Index number_of(const FloatBox& element) {
    return std::bit_cast<Index>(static_cast<float>(element.low[3])) - 0x40000000;
}
inline Float4 centre_of(const FloatBox& element) { return element.low + element.high; }  // twice the centre

// A part that is smaller than the node by this factor becomes a child of its own, so that it is cut further down,
// where the frame and the planes of the children's boxes are fine enough.
inline constexpr float finest_part = 0x1p-5F;

struct Range {
    std::int32_t begin = 0, end = 0;
    FloatBox box, centres;

    std::int32_t size() const { return end - begin; }

    // Returns the extent of the centres along the longest axis.
    float spread() const {
        const Float4 d = centres.high - centres.low;
        return 0.5F * std::max(std::max(d[0], d[1]), d[2]);
    }
};

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

    // If the centres lie so close together that single precision can hardly tell them apart, gives the elements
    // coordinates in a frame around their centres. O(size); the frame shrinks by a factor of 2^12 or more each
    // time.
    void localise(Range& range);

    // Partitions a range at `middle` along its longest axis: elements with smaller centres come first. The range
    // has at most 64 elements.
    void put_in_order(const Range& range, std::int32_t middle);

    // Appends a leaf; returns its reference as stored in nodes.
    std::int32_t add_leaf(const Range& range) {
        // The triangles of a leaf are measured four at a time, so neighbours should be in the same half.
        constexpr std::int32_t half = leaf_capacity / 2;
        if (range.size() > half) put_in_order(range, range.begin + half);
        for (std::int32_t i = range.begin; i < range.end; ++i) {
            tree.order.push_back(number_of(elements[static_cast<std::size_t>(i)]));
        }
        tree.leaf_begin.push_back(static_cast<std::int32_t>(tree.order.size()));
        return ~static_cast<std::int32_t>(tree.leaves() - 1);
    }

    // Builds the tree. split(range, depth, children) fills in at most eight parts and returns their number.
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

// Splits a range in its present order into up to eight parts of about equal size; if there are few elements, into
// one part per leaf.
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
