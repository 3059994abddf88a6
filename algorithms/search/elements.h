// What a search knows of each triangle of A, beside what it knows of all: for Result::fields, and kept only where they are wanted.
#pragma once

#include "algorithms/search/target.h"

#include <vector>

namespace hausbench {

// The farthest point of A so far, or of one triangle of it.
struct Farthest {
    MeasuredPoint point{};
    Index source = -1;  // triangle of A that it is in; -1: nothing was measured yet
    int level = 0;      // how far it may be from A by rounding, as kernel/rounding.h counts it
};

// Its functions are not inline, so that searches without it are as fast as before.
struct ElementBounds {
    std::vector<Farthest> farthest;
    std::vector<double> upper;    // the largest upper bound of a piece that was settled
    std::vector<double> deepest;  // level of subdivision of its smallest piece

    explicit ElementBounds(Index count)
        : farthest(static_cast<std::size_t>(count)),
          upper(static_cast<std::size_t>(count)),
          deepest(static_cast<std::size_t>(count)) {}

    // A point of triangle `source` was measured.
    void offer(const MeasuredPoint& point, Index source, int level);

    // A piece of triangle `source` has this upper bound, and is not looked into any more.
    void settle(double bound, Index source);

    // There is a piece of triangle `source` of this level.
    void subdivided(Index source, int level);
};

}  // namespace hausbench
