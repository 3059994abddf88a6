// Functions of the solver in scan.cpp that read all points of a set, with vector instructions that are chosen at run
// time. The results do not depend on these instructions or on the number of threads.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/counters.h"
#include "algorithms/kernel/parallel.h"
#include "algorithms/points/exact.h"

#include <span>
#include <vector>

namespace hausbench::scan {

// The bounding box of a point set, and whether the set has tiny coordinates.
struct Extent {
    Box box;
    bool tiny = false;  // whether some nonzero |coordinate| is smaller than smallest_safe_coordinate

    double magnitude() const { return std::max(box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff()); }
};
Extent extent_of(const Points& points, const Threads& threads = Threads());

// Compares each of the given rows of A with all points of B. Updates `farthest` if one of them is farther from B.
// O(|rows| * |B|).
void compare_with_all(const Points& a, std::span<const Index> rows, const Points& b, const Threads& threads,
                      FarthestPoint& farthest, Counters& counters);

// Returns the squared distance to the nearest point of B for each of the given rows of A. O(|rows| * |B|).
std::vector<double> squared_to_nearest(const Points& a, std::span<const Index> rows, const Points& b,
                                       const Threads& threads);

}  // namespace hausbench::scan
