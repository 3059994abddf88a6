// The bounds of each triangle of A in a search, for Result::fields; kept only if fields are wanted.
#pragma once

#include "algorithms/search/target.h"

#include <vector>

namespace hausbench {

// The point farthest from B among the points of A measured so far, or among the measured points of one triangle of A.
struct Farthest {
    MeasuredPoint point{};
    Index source = -1;  // the triangle of A that contains it; -1: no point was measured yet
    int level = 0;      // how far rounding may have moved it off A, as in kernel/rounding.h
};

// The bounds of all triangles of A, by triangle. The functions are not inline, so that a search without
// this object stays fast.
struct ElementBounds {
    std::vector<Farthest> farthest;
    std::vector<double> upper;    // the largest upper bound of its settled pieces (bounds.h)
    std::vector<double> deepest;  // the number of subdivisions of its smallest piece

    explicit ElementBounds(Index count)
        : farthest(static_cast<std::size_t>(count)),
          upper(static_cast<std::size_t>(count)),
          deepest(static_cast<std::size_t>(count)) {}

    // Takes a measured point of triangle `source`, and keeps it if it is the farthest of this triangle so far.
    void offer(const MeasuredPoint& point, Index source, int level);

    // Takes the upper bound of a piece of triangle `source` that is settled, or left over when the search ends.
    void settle(double bound, Index source);

    // Records that triangle `source` has a piece of this level.
    void subdivided(Index source, int level);
};

}  // namespace hausbench
