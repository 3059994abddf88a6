// A tree over a point set that is quick to build (a radix sort, then one pass) and quick to search with vector
// instructions (search.h).
//
// The points are sorted in Morton order and cut into leaves of 16. Above the leaves is a tree of boxes with eight
// children per node. It needs no pointers, because the index of a node determines its children.
#pragma once

#include "algorithms/kernel/morton.h"

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace hausbench::scan {

inline constexpr std::size_t block_points = 16;
inline constexpr std::size_t block_children = 8;

// 16 points and their rows in the set. The last leaf may have fewer points; its last point is then repeated.
struct alignas(64) PointLeaf {
    double x[block_points], y[block_points], z[block_points];
    Index row[block_points];
};

// The boxes of the eight children of a node. A missing child has low = infinity and high = -infinity, so its distance
// from every point is infinite.
struct alignas(64) BlockNode {
    double low[3][block_children], high[3][block_children];
};

// Sorts the chosen rows of `points` (all if null) in the Morton order of the frame, and cuts them into leaves. At least
// one row must be chosen.
std::vector<PointLeaf> leaves_of(const Points& points, const std::vector<Index>* chosen, const MortonFrame& frame);

// A point set cut into leaves, and the tree of boxes above them. Takes about 32 bytes per point; building takes O(n)
// time on typical data (see morton_order() in kernel/morton.h).
struct PointBlocks {
    static constexpr std::string_view structure_name = "point blocks";
    static constexpr int structure_layout = 1;

    // Builds the tree over the chosen rows of `points` (all if null). `box` must contain them.
    PointBlocks(const Points& points, const std::vector<Index>* chosen, const Box& box);
    explicit PointBlocks(const Points& points);

    // Returns the index of the leaf in which a point would be in Morton order. The points of this leaf are probably
    // near the given point. O(log n).
    std::size_t leaf_at(const double* point) const;

    MortonFrame frame;
    std::vector<PointLeaf> leaves;
    std::vector<std::uint32_t> keys;  // for each leaf: the Morton key of its first point
    // The nodes of all levels, from the bottom up. Level 1 has the leaves as children; the last level is the root
    // alone. Node i of a level has the children 8 * i to 8 * i + 7 of the level below.
    std::vector<BlockNode> nodes;
    std::vector<std::size_t> level_begin;  // level_begin[l - 1] is the index in `nodes` of the first node of level l

    std::size_t levels() const { return level_begin.size(); }
    std::size_t bytes() const {
        return leaves.capacity() * sizeof(PointLeaf) + keys.capacity() * sizeof(keys[0]) +
               nodes.capacity() * sizeof(BlockNode);
    }
};

}  // namespace hausbench::scan
