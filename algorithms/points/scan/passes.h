// Passes of points/scan/scan.cpp over all points, with vector instructions chosen at run time. The results are the
// same on every target and for any number of threads.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/counters.h"
#include "algorithms/kernel/parallel.h"
#include "algorithms/points/exact.h"

#include <span>
#include <vector>

namespace hausbench {

// The extent of a point set.
struct Extent {
    Box box;
    bool tiny = false;  // some nonzero coordinate is smaller than smallest_safe_coordinate

    double magnitude() const { return std::max(box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff()); }
};
Extent extent_of(const Points& points, const Threads& threads = Threads());

// Finds the nearest point of B to each of a few rows of A by comparing them with all of B; updates `farthest`. O(rows
// |B|).
void compare_with_all(const Points& a, std::span<const Index> rows, const Points& b, const Threads& threads,
                      FarthestPoint& farthest, Counters& counters);

// Returns the squared distance of each of a few rows of A to the nearest point of B. O(rows |B|).
std::vector<double> squared_to_nearest(const Points& a, std::span<const Index> rows, const Points& b,
                                       const Threads& threads);

}  // namespace hausbench
