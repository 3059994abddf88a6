// The inner loop of EARLYBREAK (earlybreak.cpp), which OHD takes its first lower bound by, and the options of OHD.
#pragma once

#include "options.h"
#include "points/exact.h"
#include "points/shuffle.h"

#include <cmath>

namespace hausbench {

// B in random order.
struct ShuffledTarget {
    ShuffledTarget() = default;
    ShuffledTarget(const Points& b, bool shuffle, Generator& random)
        : order(order_of(static_cast<Index>(b.rows()), shuffle, random)), points(b.rows(), 3) {
        for (std::size_t j = 0; j < order.size(); ++j) points.row(static_cast<Index>(j)) = b.row(order[j]);
    }

    std::vector<Index> order;
    Points points;

    std::size_t bytes() const {
        return order.capacity() * sizeof(Index) + static_cast<std::size_t>(points.size()) * sizeof(double);
    }
};

// One outer loop: point i of A against B until some distance is less than the largest so far, which is updated.
inline void early_break(const Points& a, Index i, const ShuffledTarget& b, FarthestPoint& farthest,
                        Counters& counters) {
    FarthestPoint nearest{std::numeric_limits<double>::infinity(), i, -1};
    for (std::size_t j = 0; j < b.order.size(); ++j) {
        ++counters.point_distances;
        const double squared = squared_distance(a.row(i).data(), b.points.row(static_cast<Index>(j)).data());
        if (squared < farthest.squared) return;
        if (squared < nearest.squared) nearest.squared = squared, nearest.target = b.order[j];
    }
    if (nearest.squared > farthest.squared) farthest = nearest;
}

// The first ceil(lambda |A|) of a random order.
inline std::vector<Index> first_of_order(Index count, double lambda, Generator& random) {
    std::vector<Index> order = order_of(count, true, random);
    order.resize(static_cast<std::size_t>(std::ceil(lambda * count)));
    return order;
}

inline std::vector<ParameterSpec> ohd_parameters() {
    return {
        {.name = "lambda",
         .default_value = 0.01,
         .unit = "of |A|",
         .paper_value = "1/100",
         .description = "outer loops of EARLYBREAK that give the first lower bound",
         .choices = {},
         .least = 0,
         .most = 1},
        {.name = "seed",
         .default_value = std::int64_t{1},
         .unit = "",
         .paper_value = "",
         .description = "of the generator that shuffles both sets",
         .choices = {},
         .least = 0,
         .most = 9e15},
    };
}

}  // namespace hausbench
