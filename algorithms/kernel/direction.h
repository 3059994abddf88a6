// Rescales very long or very short vectors, so that normalising them neither overflows nor underflows.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <cmath>

namespace hausbench {

// Returns v times the power of two that brings its largest |coordinate| into [1, 2), so that the squared length neither
// overflows nor underflows. The result is exact, except that coordinates much smaller than the largest may underflow.
// Zero and non-finite vectors are returned unchanged.
inline Vec3 at_unit_scale(const Vec3& v) {
    const double largest = v.cwiseAbs().maxCoeff();
    if (!(largest > 0) || !v.allFinite()) return v;
    const int exponent = std::ilogb(largest);
    return v.unaryExpr([&](double x) { return std::ldexp(x, -exponent); });
}

}  // namespace hausbench
