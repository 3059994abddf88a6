// Searches leaves of A in the tree of B, with vector instructions chosen at run time. Answers have the same bits on
// every target.
#pragma once

#include "algorithms/kernel/counters.h"
#include "algorithms/points/exact.h"
#include "algorithms/points/scan/point_blocks.h"

#include <cstdint>
#include <span>
#include <vector>

namespace hausbench {

// State of a search; the leaf of the last answer carries over from one leaf of A to the next.
struct ScanState {
    FarthestPoint farthest;
    Counters counters;
    std::size_t last_leaf = 0;
};

// Updates state.farthest with one point of every fourth leaf, so that most other points are then decided at once.
void search_samples(const PointBlocks& b, std::span<const PointLeaf> a, ScanState& state);

// Updates state.farthest with all points of the leaves.
void search_leaves(const PointBlocks& b, std::span<const PointLeaf> a, ScanState& state);

// Returns the Highway target whose instructions run, for tests.
std::int64_t scan_target();

}  // namespace hausbench
