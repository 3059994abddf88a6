// Bounds of each triangle of A, kept during a search if the query wants fields (Result::fields).
#pragma once

#include "algorithms/search/target.h"

#include <vector>

namespace hausbench {

// The point farthest from B among the points measured so far, either on all of A or on one triangle of A.
struct Farthest {
    MeasuredPoint point{};
    Index source = -1;  // the triangle of A that contains `point`; -1: none yet
    int level = 0;      // limits how far rounding may have moved `point` off A (kernel/rounding.h)
};

// Bounds for each triangle of A, indexed by triangle. The functions are not inline, because inlining slows down
// searches that do not use them.
struct ElementBounds {
    std::vector<Farthest> farthest;
    std::vector<double> upper;    // largest upper bound of its dropped pieces
    std::vector<double> deepest;  // number of subdivisions that led to its smallest piece

    explicit ElementBounds(Index count)
        : farthest(static_cast<std::size_t>(count)),
          upper(static_cast<std::size_t>(count)),
          deepest(static_cast<std::size_t>(count)) {}

    // Keeps a measured point of triangle `source` if it is the farthest of this triangle so far.
    void offer(const MeasuredPoint& point, Index source, int level);

    // Raises the upper bound of triangle `source` to `bound`, the bound of a piece that was dropped or is left at the
    // end of the search.
    void settle(double bound, Index source);

    // Records that triangle `source` has a piece after `level` subdivisions.
    void subdivided(Index source, int level);
};

}  // namespace hausbench
