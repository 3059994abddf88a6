// What the builders of trees share: elements with their boxes, ranges of them, and how nodes are made of ranges. Not for
// use elsewhere.
#pragma once

#include "wide_tree.h"

#include <array>
#include <bit>
#include <limits>
#include <utility>

namespace hausbench::builder {

// Half the surface.
inline float area(const FloatBox& box) {
    const Float4 d = box.high - box.low;
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
}

// While a tree is built, the bits of the fourth number of `low` tell which element it is. As numbers they are 2 or more:
// never subnormal, which would be slow.
inline void set_number(FloatBox& element, Index number) { element.low[3] = std::bit_cast<float>(number + 0x40000000); }
inline Index number_of(const FloatBox& element) {
    return std::bit_cast<Index>(static_cast<float>(element.low[3])) - 0x40000000;
}
inline Float4 centre_of(const FloatBox& element) { return element.low + element.high; }  // twice

struct Range {
    std::int32_t begin = 0, end = 0;
    FloatBox box, centres;

    std::int32_t size() const { return end - begin; }
};

struct Builder {
    std::vector<FloatBox> elements;
    WideTree tree;

    explicit Builder(LocalBoxes&& boxes) : elements(std::move(boxes.boxes)) {
        tree.frame = boxes.frame;
        for (std::size_t i = 0; i < elements.size(); ++i) set_number(elements[i], static_cast<Index>(i));
        tree.order.reserve(elements.size());
        tree.leaf_begin.push_back(0);
    }

    Range range(std::int32_t begin, std::int32_t end) const {
        Range result{begin, end, {}, {}};
        for (std::int32_t i = begin; i < end; ++i) {
            const FloatBox& element = elements[static_cast<std::size_t>(i)];
            result.box.add(element);
            result.centres.add(centre_of(element));
        }
        return result;
    }

    // Appends a leaf; returns how nodes refer to it.
    std::int32_t add_leaf(const Range& range) {
        for (std::int32_t i = range.begin; i < range.end; ++i) {
            tree.order.push_back(number_of(elements[static_cast<std::size_t>(i)]));
        }
        tree.leaf_begin.push_back(static_cast<std::int32_t>(tree.order.size()));
        return ~static_cast<std::int32_t>(tree.leaves() - 1);
    }

    // Builds the tree; split(range, depth, children) fills in at most eight parts and returns how many.
    template <class Split> WideTree build(Split&& split) {
        add_node(range(0, static_cast<std::int32_t>(elements.size())), 0, split);
        tree.nodes.shrink_to_fit();
        tree.leaf_begin.shrink_to_fit();
        return std::move(tree);
    }

    template <class Split> std::int32_t add_node(const Range& whole, int depth, Split&& split) {
        std::array<Range, tree_width> parts;
        int count = 1;
        parts[0] = whole;
        if (whole.size() > leaf_capacity) count = split(whole, depth, parts);

        const std::size_t at = tree.nodes.size();
        tree.nodes.emplace_back();
        for (int c = 0; c < tree_width; ++c) {
            // What is not in use repeats the first child; the walk leaves it out by the count.
            const FloatBox& box = parts[static_cast<std::size_t>(c < count ? c : 0)].box;
            for (int k = 0; k < 3; ++k) {
                tree.nodes[at].low[k][c] = box.low[k];
                tree.nodes[at].high[k][c] = box.high[k];
            }
            tree.nodes[at].child[c] = 0;
        }
        tree.nodes[at].count = count;
        for (int c = 0; c < count; ++c) {
            const Range& part = parts[static_cast<std::size_t>(c)];
            const std::int32_t child = part.size() <= leaf_capacity ? add_leaf(part) : add_node(part, depth + 1, split);
            tree.nodes[at].child[c] = child;
        }
        return static_cast<std::int32_t>(at);
    }
};

// Eight parts of about equal numbers, in the order they have; whole leaves where there are few.
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
