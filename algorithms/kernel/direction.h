// Directions of vectors of any length.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <cmath>

namespace hausbench {

// Returns the vector times the power of two that brings its largest |coordinate| into [1, 2), so that its squares
// neither underflow nor overflow. Exact, except for coordinates that vanish beside the largest. Zero and vectors that
// are not finite stay as they are.
inline Vec3 at_unit_scale(const Vec3& v) {
    const double largest = v.cwiseAbs().maxCoeff();
    if (!(largest > 0) || !v.allFinite()) return v;
    const int exponent = std::ilogb(largest);
    return v.unaryExpr([&](double x) { return std::ldexp(x, -exponent); });
}

}  // namespace hausbench
