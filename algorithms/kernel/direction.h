// Directions of vectors of any length.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <cmath>

namespace hausbench {

// Returns the vector times the power of two that brings its largest |coordinate| into [1, 2), so that squares of it neither underflow nor
// overflow: exactly, but for coordinates that are nothing beside the largest. Zero, and what is not finite, stays as it is.
inline Vec3 at_unit_scale(const Vec3& v) {
    const double largest = v.cwiseAbs().maxCoeff();
    if (!(largest > 0) || !v.allFinite()) return v;
    const int exponent = std::ilogb(largest);
    return v.unaryExpr([&](double x) { return std::ldexp(x, -exponent); });
}

}  // namespace hausbench
