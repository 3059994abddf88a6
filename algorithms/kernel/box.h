// Axis-aligned boxes.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <algorithm>
#include <limits>

namespace hausbench {

// A closed box, given by its smallest and its largest corner. A new box is empty; add() enlarges it.
struct Box {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = Vec3::Constant(-std::numeric_limits<double>::infinity());

    void add(const Vec3& point) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    void add(const Box& box) {
        low = low.cwiseMin(box.low);
        high = high.cwiseMax(box.high);
    }
};

// Returns the squared distance from p to the box, rounded after each operation. It never exceeds the computed squared
// distance from p to a point of the box (squared_length() in triangle.h), so a search may compare the two without slack
// for rounding. The reason is that both functions perform the same operations in the same order, and rounding is
// monotone.
inline double squared_distance_to_box(const Vec3& p, const Box& box) {
    double d[3];
    for (int k = 0; k < 3; ++k) d[k] = std::max(std::max(box.low[k] - p[k], p[k] - box.high[k]), 0.0);
    return (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
}

}  // namespace hausbench
