// Searches the tree of B (point_blocks.h) for the nearest points to the points of A, which are in leaves, too: step 6
// of scan.cpp. Uses vector instructions that are chosen at run time; the results are the same whichever of them run.
#pragma once

#include "algorithms/kernel/counters.h"
#include "algorithms/points/exact.h"
#include "algorithms/points/scan/point_blocks.h"

#include <cstdint>
#include <span>
#include <vector>

namespace hausbench {

// The state of the search for one query, which all steps of scan.cpp update.
struct ScanState {
    FarthestPoint farthest;  // the largest distance so far
    Counters counters;
    std::size_t last_leaf = 0;  // the leaf of B with the point found last; points of A that follow are probably near it
};

// Updates state.farthest with the first point of every fourth leaf of A. Call it before search_leaves(): the largest
// distance is then nearly final, so most points are decided at once.
void search_samples(const PointBlocks& b, std::span<const PointLeaf> a, ScanState& state);

// Updates state.farthest with all points of these leaves of A.
void search_leaves(const PointBlocks& b, std::span<const PointLeaf> a, ScanState& state);

// Returns the target of the Highway library (the instruction set) that runs on this machine, for tests.
std::int64_t scan_target();

}  // namespace hausbench
