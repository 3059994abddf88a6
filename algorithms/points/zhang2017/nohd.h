// Code shared by nohd.cpp and nohd_as_printed.cpp: the queue entries, and Algorithm 4 of Zhang et al. 2017, which is
// correct as printed. The two files differ in Algorithms 3 and 5.
#pragma once

#include "algorithms/kernel/posed_box.h"
#include "algorithms/points/exact.h"
#include "algorithms/points/zhang2017/octree_cursor.h"

#include <limits>

namespace hausbench::zhang2017 {

// A cell of A in the queue. The cell with the largest upper bound comes first.
struct NohdEntry {
    double squared_upper;  // upper bound on the squared distances of its points to B; the paper's MinUB
    std::uint64_t number;  // breaks ties: the lower number comes first
    Cursor cell;

    bool operator<(const NohdEntry& other) const {
        return squared_upper != other.squared_upper ? squared_upper < other.squared_upper : number > other.number;
    }
};

// Bounds on the distance to B that hold for every point of one cell of A (Zhang et al. 2017, Algorithm 4).
struct CellToPoints {
    double squared_upper, squared_lower;  // bounds on the squared distance to B of every point of the cell
    // Whether some point of the cell may be farther from B than the largest lower bound so far (`flag` in the paper).
    // If false, the cell can be dropped, and squared_lower is not valid.
    bool undecided;
};

// Algorithm 4 of the paper: compares a cell of A with the points of B, to bound the distances from its points to B.
// Stops early if no point of the cell can be farther than the largest lower bound so far (MaxLB; `squared_max_lb` is
// its square). With early_break = false, leaves out lines 5 to 8 and never stops early.
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

// Returns the row in A of some point of the cell.
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

}  // namespace hausbench::zhang2017
