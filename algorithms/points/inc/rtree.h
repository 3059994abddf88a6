// R-tree over a point set, packed by sorting and tiling.
//
// Source: Leutenegger, Lopez, Edgington: STR: a simple and efficient algorithm for R-tree packing, ICDE 1997.
#pragma once

#include "algorithms/kernel/box.h"

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace hausbench {

class RTree {
public:
    static constexpr std::string_view structure_name = "R-tree";
    static constexpr int structure_layout = 1;

    struct Node {
        Box box;  // tight
        // Range of its children: nodes, or positions in order() if this is a leaf.
        std::int32_t first, count;
        bool leaf;
    };

    // Copies the points. O(n log n) time, O(n) memory.
    explicit RTree(const Points& points);

    const std::vector<Node>& nodes() const { return nodes_; }  // the root is the last
    const std::vector<Index>& order() const { return order_; }
    const Points& points() const { return points_; }  // sorted by order()

    std::size_t bytes() const;

    static constexpr std::int32_t capacity = 16;  // children of a node

private:
    std::vector<Node> nodes_;
    std::vector<Index> order_;
    Points points_;
};

}  // namespace hausbench
