// The inner loop of the solver EARLYBREAK (earlybreak.cpp). The solver OHD (zhang2017/ohd.cpp) also uses it, to get a
// first lower bound on the Hausdorff distance.
#pragma once

#include "algorithms/kernel/deadline.h"
#include "algorithms/options.h"
#include "algorithms/points/exact.h"
#include "algorithms/points/shuffle.h"

#include <algorithm>
#include <limits>

namespace hausbench {

// The points of B in random order, or in their own order if `shuffle` is false.
struct ShuffledTarget {
    ShuffledTarget() = default;
    ShuffledTarget(const Points& b, bool shuffle, Generator& random)
        : order(order_of(static_cast<Index>(b.rows()), shuffle, random)), points(b.rows(), 3) {
        for (std::size_t j = 0; j < order.size(); ++j) points.row(static_cast<Index>(j)) = b.row(order[j]);
    }

    std::vector<Index> order;  // row j of `points` is row order[j] of B
    Points points;

    std::size_t bytes() const {
        return order.capacity() * sizeof(Index) + static_cast<std::size_t>(points.size()) * sizeof(double);
    }
};

// Compares point i of A with the points of B one by one. Stops at the first squared distance below `farthest.squared`,
// because point i then cannot be the farthest point of A. Otherwise the distance of point i is known, and `farthest`
// becomes point i if it is farther.
//
// Returns false if time runs out first; point i then counts as not examined. Not inlined, so that the compiler can use
// all registers for the loop.
[[gnu::noinline]] inline bool early_break(const Points& a, Index i, const ShuffledTarget& b, const Deadline& deadline,
                                          FarthestPoint& farthest, Counters& counters) {
    constexpr Index block = 4096;  // points of B between two checks of the clock
    const double* point = a.row(i).data();
    const auto count = static_cast<Index>(b.order.size());
    double nearest = std::numeric_limits<double>::infinity();
    Index at = -1;
    for (Index begin = 0; begin < count; begin += block) {
        if (deadline.passed()) return false;
        const Index end = std::min(begin + block, count);
        for (Index j = begin; j < end; ++j) {
            const double squared = squared_distance(point, b.points.row(j).data());
            if (squared < farthest.squared) {
                counters.point_distances += static_cast<std::uint64_t>(j - begin + 1);
                return true;
            }
            if (squared < nearest) {
                nearest = squared;
                at = j;
            }
        }
        counters.point_distances += static_cast<std::uint64_t>(end - begin);
    }
    if (nearest > farthest.squared) farthest = {nearest, i, b.order[static_cast<std::size_t>(at)]};
    return true;
}

inline ParameterSpec seed_parameter() {
    return {.name = "seed",
            .default_value = std::int64_t{1},
            .description = "seed of the generator that shuffles both sets",
            .least = 0,
            .most = 9e15};
}

}  // namespace hausbench
