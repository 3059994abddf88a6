// The bounds of each triangle of A in a search, for Result::fields; kept only if fields are wanted.
#pragma once

#include "algorithms/search/target.h"

#include <vector>

namespace hausbench {

// The farthest point so far, of A or of one triangle of it.
struct Farthest {
    MeasuredPoint point{};
    Index source = -1;  // its triangle of A; -1: nothing measured yet
    int level = 0;      // its possible distance from A by rounding, in the levels of kernel/rounding.h
};

// The bounds of all triangles of A. Its functions are not inline, so that searches without it stay fast.
struct ElementBounds {
    std::vector<Farthest> farthest;
    std::vector<double> upper;    // the largest upper bound of a settled piece
    std::vector<double> deepest;  // level of subdivision of its smallest piece

    explicit ElementBounds(Index count)
        : farthest(static_cast<std::size_t>(count)),
          upper(static_cast<std::size_t>(count)),
          deepest(static_cast<std::size_t>(count)) {}

    // Takes a measured point of triangle `source`.
    void offer(const MeasuredPoint& point, Index source, int level);

    // Settles a piece of triangle `source` with this upper bound.
    void settle(double bound, Index source);

    // Records that triangle `source` has a piece of this level.
    void subdivided(Index source, int level);
};

}  // namespace hausbench
