// Leaves of A against the tree of B, in vector instructions chosen at run time; answers are the same bits on every target.
#pragma once

#include "algorithms/kernel/counters.h"
#include "algorithms/points/exact.h"
#include "algorithms/points/scan/point_blocks.h"

#include <cstdint>
#include <span>
#include <vector>

namespace hausbench {

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
