// An octree over a point set, as Zhang et al. 2017 use it: NOHD bounds the distances of all points in a cell of A at
// once, and OHD searches the cells of B.
#pragma once

#include "algorithms/kernel/box.h"

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace hausbench::zhang2017 {

// Return the box of an octant of a cell, and the octant that contains a point of the cell. Octants are numbered from 0
// to 7: bit k is set for the upper half along axis k. Both functions use the same rounded middle of the cell, so the
// box of an octant contains its points in spite of rounding.
Box part_of(const Box& cell, int octant);
int octant_of(const Box& cell, const Vec3& point);

// An octree over a copy of the points. The root is a cube around the points, and each cell with different points is
// split into its octants. No node is stored for a cell whose points are all in one octant, but its level counts in
// Node::depth. So a tree of n points has fewer than 2n nodes.
class PointOctree {
public:
    static constexpr std::string_view structure_name = "point octree";
    static constexpr int structure_layout = 1;

    struct Node {
        Box cell;
        std::int32_t depth;  // how often the cube of the root was halved
        // The children are nodes()[first_child] and the child_count - 1 nodes after it. A node without children is a
        // leaf: its points coincide, or it is at the largest depth.
        std::int32_t first_child, child_count;
        std::int32_t first, count;  // the range of its points in order() and points()
    };

    // Builds the octree in O(n * depth) time and O(n) memory.
    explicit PointOctree(const Points& points);
    // Builds the octree from a given root, which must be a cube that contains the points. Does not split cells at depth
    // `deepest`, so they are leaves that may have many different points.
    PointOctree(const Points& points, const Box& root_cell, int deepest = max_depth);

    // Returns the root that the first constructor uses: a cube that contains the points and has the low corner of their
    // box.
    static Box root_around(const Points& points);

    const std::vector<Node>& nodes() const { return nodes_; }   // the root comes first
    const std::vector<Index>& order() const { return order_; }  // rows of the input; each node has a range of them
    const Points& points() const { return points_; }            // row i is row order()[i] of the input
    // Returns the cell of depth 0. The cell of the root node may be smaller, because the tree skips levels.
    const Box& root_cell() const { return root_cell_; }

    std::size_t bytes() const;

    static constexpr int max_depth = 60;

private:
    void build(std::int32_t at, std::int32_t first, std::int32_t count, Box cell, int depth);

    int deepest_;
    Box root_cell_;
    std::vector<Node> nodes_;
    std::vector<Index> order_, scratch_;
    Points points_;
};

}  // namespace hausbench::zhang2017
