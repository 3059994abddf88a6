// Bounds of computed distances between boxes, points and posed boxes, with no slack for rounding.
//
// All distances between points here are fl(((ax-bx)^2 + (ay-by)^2) + (az-bz)^2), rounded after each operation.
// Rounding is monotone: x <= y implies fl(x) <= fl(y). So the same operations on the ends of intervals that contain
// the coordinates bound the computed result for all coordinates inside, exactly.
#pragma once

#include "algorithms/kernel/box.h"

#include <algorithm>
#include <cmath>

namespace hausbench {

// Returns a box that contains posed(p) (geometry.h) for every p in `box`. It does the operations of posed() on
// whichever end of the box makes each product least or most. For the identity the result is the box itself; for a
// rotation it is the box around the turned box, clipped to `within`. `within` must contain all posed points;
// clipping also removes overflow at a corner.
inline Box posed_box(const Box& box, const Pose& pose, const Box& within) {
    if (pose.is_identity()) return box;
    Box result;
    for (int k = 0; k < 3; ++k) {
        double low[3], high[3];
        for (int j = 0; j < 3; ++j) {
            const double r = pose.rotation(k, j);
            low[j] = r * (r >= 0 ? box.low[j] : box.high[j]);
            high[j] = r * (r >= 0 ? box.high[j] : box.low[j]);
        }
        const double least = ((low[0] + low[1]) + low[2]) + pose.translation[k];
        const double most = ((high[0] + high[1]) + high[2]) + pose.translation[k];
        result.low[k] = least > within.low[k] ? least : within.low[k];  // if NaN: the end of `within`
        result.high[k] = most < within.high[k] ? most : within.high[k];
    }
    return result;
}

inline Box box_of(const Points& points) {
    Box box;
    for (Eigen::Index i = 0; i < points.rows(); ++i) box.add(points.row(i));
    return box;
}

// Lower and upper bound of the squared distance between any p in one box and any q in the other.
inline double squared_distance_at_least(const Box& a, const Box& b) {
    double d[3];
    for (int k = 0; k < 3; ++k) d[k] = std::max(std::max(b.low[k] - a.high[k], a.low[k] - b.high[k]), 0.0);
    return (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
}

inline double squared_distance_at_most(const Box& a, const Box& b) {
    double d[3];
    for (int k = 0; k < 3; ++k) d[k] = std::max(b.high[k] - a.low[k], a.high[k] - b.low[k]);
    return (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
}

// Returns the squared distance from p to the farthest corner.
inline double squared_distance_at_most(const Vec3& p, const Box& box) {
    double d[3];
    for (int k = 0; k < 3; ++k) d[k] = std::max(box.high[k] - p[k], p[k] - box.low[k]);
    return (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
}

}  // namespace hausbench
