// Points in Morton order, sixteen per leaf, under an implicit tree of boxes with eight children per node.
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

// Returns the chosen rows of `points` (all if null), at least one, in the Morton order of the frame.
std::vector<PointLeaf> leaves_of(const Points& points, const std::vector<Index>* chosen, const MortonFrame& frame);

// Builds in O(n) for tame data (see morton.h); O(n) memory, about 37 bytes per point.
struct PointBlocks {
    static constexpr std::string_view structure_name = "point blocks";
    static constexpr int structure_layout = 1;

    // `box` contains the chosen points.
    PointBlocks(const Points& points, const std::vector<Index>* chosen, const Box& box);
    explicit PointBlocks(const Points& points);

    // Returns the leaf at the position of this point in the order; it is probably near the point. O(log n).
    std::size_t leaf_at(const double* point) const;

    MortonFrame frame;
    std::vector<PointLeaf> leaves;
    std::vector<std::uint32_t> keys;  // of the first point of each leaf
    // Level 1 has the boxes of leaves, the last level is a single node; node i of a level has children 8i to 8i + 7
    // on the level below.
    std::vector<BlockNode> nodes;
    std::vector<std::size_t> level_begin;  // start in `nodes` of level 1 and up

    std::size_t levels() const { return level_begin.size(); }
    std::size_t bytes() const {
        return leaves.capacity() * sizeof(PointLeaf) + keys.capacity() * sizeof(keys[0]) +
               nodes.capacity() * sizeof(BlockNode);
    }
};

}  // namespace hausbench
