// The inner loops of points/scan.cpp, in vector instructions chosen at run time; answers are the same bits on every target.
#pragma once

#include "kernel/counters.h"
#include "points/exact.h"
#include "structures/point_blocks.h"

#include <cstdint>
#include <span>
#include <vector>

namespace hausbench {

// What one pass over points tells.
struct Extent {
    Box box;
    bool tiny = false;  // some coordinate is not 0 but smaller than smallest_safe_coordinate

    double magnitude() const { return std::max(box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff()); }
};
Extent extent_of(const Points& points);

// The nearest point of B to each of a few rows of A, by comparing with all; updates `farthest`. O(rows |B|).
void compare_with_all(const Points& a, std::span<const Index> rows, const Points& b, FarthestPoint& farthest,
                      Counters& counters);

// The squared distance of each of a few rows of A to the nearest point of B. O(rows |B|).
std::vector<double> squared_to_nearest(const Points& a, std::span<const Index> rows, const Points& b);

// Leaves of A against the tree of B. What carries over from one leaf to the next is where the last answer was.
struct ScanState {
    FarthestPoint farthest;
    Counters counters;
    std::size_t last_leaf = 0;
};

// Updates state.farthest by one point of every fourth leaf: when the others follow, most are decided at once.
void search_samples(const PointBlocks& b, std::span<const PointLeaf> a, ScanState& state);

// Updates it by all points of the leaves.
void search_leaves(const PointBlocks& b, std::span<const PointLeaf> a, ScanState& state);

// The Highway target whose instructions run, for tests.
std::int64_t scan_target();

}  // namespace hausbench
