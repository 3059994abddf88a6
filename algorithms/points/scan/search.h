// Step 6 of scan.cpp: searches a tree over B (point_blocks.h) for the nearest points to the points of A, which are also
// sorted into leaves. Uses vector instructions that are chosen at run time; the results do not depend on them.
#pragma once

#include "algorithms/kernel/counters.h"
#include "algorithms/points/exact.h"
#include "algorithms/points/scan/point_blocks.h"

#include <cstdint>
#include <span>
#include <vector>

namespace hausbench::scan {

// The state of the search for one query, which all steps of scan.cpp update.
struct ScanState {
    FarthestPoint farthest;
    Counters counters;
    std::size_t last_leaf = 0;  // the leaf of B with the point found last; the next points of A are probably near it
};

// Updates state.farthest with a sample of A: the first point of every fourth leaf. Call it before search_leaves(). The
// largest distance is then nearly final, so most points can be skipped quickly.
void search_samples(const PointBlocks& b, std::span<const PointLeaf> a, ScanState& state);

// Updates state.farthest with the distances to B of all points in these leaves of A.
void search_leaves(const PointBlocks& b, std::span<const PointLeaf> a, ScanState& state);

// Returns the instruction set that the Highway library chose on this machine (HWY_TARGET), for tests.
std::int64_t scan_target();

}  // namespace hausbench::scan
