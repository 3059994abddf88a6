// The inner loops of points/scan.cpp, in vector instructions chosen at run time; answers are the same bits on every target.
#pragma once

#include "kernel/counters.h"
#include "kernel/point_blocks.h"
#include "points/exact.h"

#include <span>

namespace hausbench {

// What one pass over points tells.
struct Extent {
    Box box;
    bool tiny = false;  // some coordinate is not 0 but smaller than smallest_safe_coordinate

    double magnitude() const { return std::max(box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff()); }
};
Extent extent_of(const Points& points);

// The nearest point of B to each of a few rows of A, by comparing with all; raises `farthest`. O(rows |B|).
void raise_by_scan(const Points& a, std::span<const Index> rows, const Points& b, FarthestPoint& farthest,
                   Counters& counters);

// Leaves of A against the tree of B. What carries over from one leaf to the next is where the last answer was.
struct ScanState {
    FarthestPoint farthest;
    Counters counters;
    std::size_t last_leaf = 0;
};

// Raises state.farthest by one point of every fourth leaf: when the others follow, most are given up at once.
void raise_by_samples(const PointBlocks& b, const PointLeaves& a, ScanState& state);

// Raises it by all points of the leaves [begin, end).
void raise_by_leaves(const PointBlocks& b, const PointLeaves& a, std::size_t begin, std::size_t end, ScanState& state);

}  // namespace hausbench
