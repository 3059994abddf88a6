// Bounds on the computed squared distances between all points of two boxes, one of which may be moved by a pose. They
// need no slack for rounding.
//
// The reason: squared distances are always computed as ((ax-bx)^2 + (ay-by)^2) + (az-bz)^2, rounded after each
// operation, and rounding is monotone (x <= y implies round(x) <= round(y)). So the same operations, applied to the
// ends of intervals that contain the coordinates, bound the computed result for all coordinates in these intervals.
#pragma once

#include "algorithms/kernel/box.h"

#include <algorithm>
#include <cmath>

namespace hausbench {

// Returns a box that contains the computed posed(p) (geometry.h) of every point p of a shape in `box`. `within` must
// contain all posed points of the shape. The result is clipped to it, because the box around a rotated box is larger
// than its content. Clipping also removes a corner that overflowed. For the identity, the result is `box`.
//
// The smallest coordinates come from the operations of posed(), in their order, on those ends of `box` that make each
// product as small as possible. For the largest coordinates, the ends make each product as large as possible.
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
        result.low[k] = least > within.low[k] ? least : within.low[k];  // if `least` is NaN, takes within.low
        result.high[k] = most < within.high[k] ? most : within.high[k];
    }
    return result;
}

// Returns the bounding box of the points.
inline Box box_of(const Points& points) {
    Box box;
    for (Eigen::Index i = 0; i < points.rows(); ++i) box.add(points.row(i));
    return box;
}

// Returns a lower bound on the computed squared distance between any point of one box and any point of the other.
inline double squared_distance_at_least(const Box& a, const Box& b) {
    double d[3];
    for (int k = 0; k < 3; ++k) d[k] = std::max(std::max(b.low[k] - a.high[k], a.low[k] - b.high[k]), 0.0);
    return (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
}

// Returns an upper bound on the computed squared distance between any point of one box and any point of the other.
inline double squared_distance_at_most(const Box& a, const Box& b) {
    double d[3];
    for (int k = 0; k < 3; ++k) d[k] = std::max(b.high[k] - a.low[k], a.high[k] - b.low[k]);
    return (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
}

// Returns the squared distance from p to the farthest corner of the box: an upper bound for all points of the box.
inline double squared_distance_at_most(const Vec3& p, const Box& box) {
    double d[3];
    for (int k = 0; k < 3; ++k) d[k] = std::max(box.high[k] - p[k], p[k] - box.low[k]);
    return (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
}

}  // namespace hausbench
