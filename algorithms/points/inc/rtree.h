// An R-tree over a point set, built by sorting the points so that every node but the last of each level is full.
//
// Source: Leutenegger, Lopez, Edgington: STR: a simple and efficient algorithm for R-tree packing, ICDE 1997.
#pragma once

#include "algorithms/kernel/box.h"

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace hausbench::inc {

class RTree {
public:
    static constexpr std::string_view structure_name = "R-tree";
    static constexpr int structure_layout = 1;

    struct Node {
        Box box;  // the smallest box around its points
        // The children are nodes()[first] to nodes()[first + count - 1]. A leaf has points instead: order()[first] to
        // order()[first + count - 1].
        std::int32_t first, count;
        bool leaf;
    };

    // Builds the tree over a copy of the points. O(n log n) time, O(n) memory.
    explicit RTree(const Points& points);

    const std::vector<Node>& nodes() const { return nodes_; }   // the root is the last
    const std::vector<Index>& order() const { return order_; }  // rows of the input, neighbours in space together
    const Points& points() const { return points_; }            // row i is row order()[i] of the input

    std::size_t bytes() const;

    static constexpr std::int32_t capacity = 16;  // largest number of children of a node, or points of a leaf

private:
    std::vector<Node> nodes_;
    std::vector<Index> order_;
    Points points_;
};

}  // namespace hausbench::inc
