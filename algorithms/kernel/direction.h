// Directions of vectors of any length.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <cmath>

namespace hausbench {

// Returns v times the power of two that brings its largest |coordinate| into [1, 2), so that squares neither
// underflow nor overflow. Exact, except that coordinates negligible beside the largest may underflow. Zero and
// non-finite vectors are returned unchanged.
inline Vec3 at_unit_scale(const Vec3& v) {
    const double largest = v.cwiseAbs().maxCoeff();
    if (!(largest > 0) || !v.allFinite()) return v;
    const int exponent = std::ilogb(largest);
    return v.unaryExpr([&](double x) { return std::ldexp(x, -exponent); });
}

}  // namespace hausbench
