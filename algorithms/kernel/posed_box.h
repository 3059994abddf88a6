// Bounds of computed distances between boxes, points and posed boxes, with no slack for rounding.
//
// All distances between points here are fl(((ax-bx)^2 + (ay-by)^2) + (az-bz)^2), rounded after each operation.
// Rounding is monotone: x <= y implies fl(x) <= fl(y). So the same operations on the ends of intervals that contain
// the coordinates bound the results for all coordinates inside, to the bit.
#pragma once

#include "algorithms/kernel/box.h"

#include <algorithm>
#include <cmath>

namespace hausbench {

// Holds posed(p) (geometry.h) for every p in the box: the operations of posed() on whichever end of the box makes each product
// least or most. For the identity it is the box itself; for a rotation the box around the turned box, as far as it lies in
// `within`, which must hold all those points (and keeps what overflows at a corner out).
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
        result.low[k] = least > within.low[k] ? least : within.low[k];  // NaN: that of `within`
        result.high[k] = most < within.high[k] ? most : within.high[k];
    }
    return result;
}

inline Box box_of(const Points& points) {
    Box box;
    for (Eigen::Index i = 0; i < points.rows(); ++i) box.add(points.row(i));
    return box;
}

// Squared distances: at least the first, at most the second, for any p in one and q in the other.
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

// To the farthest corner.
inline double squared_distance_at_most(const Vec3& p, const Box& box) {
    double d[3];
    for (int k = 0; k < 3; ++k) d[k] = std::max(box.high[k] - p[k], p[k] - box.low[k]);
    return (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
}

}  // namespace hausbench
