// Points in Morton order, sixteen a leaf, under an implicit tree of boxes with eight children a node.
//
// Quick to build (a radix sort, then one pass), and quick to search with vector instructions (points/scan/search.h).
#pragma once

#include "algorithms/kernel/morton.h"

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace hausbench {

inline constexpr std::size_t block_points = 16;
inline constexpr std::size_t block_children = 8;

// A leaf with fewer points repeats the last one.
struct alignas(64) PointLeaf {
    double x[block_points], y[block_points], z[block_points];
    Index row[block_points];
};

// Missing children have low = infinity, high = -infinity, so they are infinitely far from everything.
struct alignas(64) BlockNode {
    double low[3][block_children], high[3][block_children];
};

// The chosen rows of `points` (all if null), at least one, in the Morton order of the frame.
std::vector<PointLeaf> leaves_of(const Points& points, const std::vector<Index>* chosen, const MortonFrame& frame);

// O(n) for tame data (see morton.h), O(n) memory: about 37 bytes a point.
struct PointBlocks {
    static constexpr std::string_view structure_name = "point blocks";
    static constexpr int structure_layout = 1;

    // `box` is that of the chosen points, or larger.
    PointBlocks(const Points& points, const std::vector<Index>* chosen, const Box& box);
    explicit PointBlocks(const Points& points);

    // Returns the leaf at the place of this point in the order. O(log n). It is likely to be near, without a guarantee.
    std::size_t leaf_at(const double* point) const;

    MortonFrame frame;
    std::vector<PointLeaf> leaves;
    std::vector<std::uint32_t> keys;  // of the first point of each leaf
    // Level 1 has the boxes of leaves, the last level is one node; node i of a level has children 8i to 8i + 7 below.
    std::vector<BlockNode> nodes;
    std::vector<std::size_t> level_begin;  // in `nodes`, of level 1 and up

    std::size_t levels() const { return level_begin.size(); }
    std::size_t bytes() const {
        return leaves.capacity() * sizeof(PointLeaf) + keys.capacity() * sizeof(keys[0]) +
               nodes.capacity() * sizeof(BlockNode);
    }
};

}  // namespace hausbench
