// Algorithm 4 of Zhang et al. 2017, which is correct as printed, and the queue entries, shared by nohd.cpp and
// nohd_as_printed.cpp. Each of these files has its own Algorithms 3 and 5.
#pragma once

#include "algorithms/kernel/posed_box.h"
#include "algorithms/points/exact.h"
#include "algorithms/points/zhang2017/octree_cursor.h"

#include <limits>

namespace hausbench {

struct NohdEntry {
    double squared_upper;  // MinUB
    std::uint64_t number;  // breaks ties: the lower number comes first
    Cursor cell;

    bool operator<(const NohdEntry& other) const {
        return squared_upper != other.squared_upper ? squared_upper < other.squared_upper : number > other.number;
    }
};

struct CellToPoints {
    double squared_upper, squared_lower;  // bounds for the distances of the points of a cell
    bool undecided;                       // flag: a point of the cell may be farther than MaxLB
};

// Algorithm 4. If `early_break` is false, omits lines 5 to 8: every cell is undecided.
inline CellToPoints cell_to_points(const Box& cell, const Points& b, double squared_max_lb, bool early_break,
                                   Counters& counters) {
    ++counters.node_visits;
    CellToPoints bounds{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), true};
    Index j = 0;
    for (; j < b.rows() && bounds.undecided; ++j) {
        const Vec3 y = b.row(j);
        const double most = squared_distance_at_most(y, cell);
        bounds.undecided = !(early_break && most <= squared_max_lb);
        bounds.squared_upper = std::min(bounds.squared_upper, most);
        bounds.squared_lower = std::min(bounds.squared_lower, squared_distance_to_box(y, cell));
    }
    counters.bound_tests += static_cast<std::uint64_t>(j);
    return bounds;
}

inline Index first_point(const PointOctree& tree, const Cursor& cell) {
    return tree.order()[static_cast<std::size_t>(tree.nodes()[static_cast<std::size_t>(cell.node)].first)];
}

inline ParameterSpec nohd_depth_parameter() {
    return {.name = "depth",
            .default_value = std::int64_t{6},
            .paper_value = "6",
            .description = "depth of the octree, whose smallest cells have the longest side of A's box over 2^depth",
            .least = 0,
            .most = PointOctree::max_depth};
}

}  // namespace hausbench
