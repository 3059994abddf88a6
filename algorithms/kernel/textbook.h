// Computes the closest point of a triangle as textbooks and most programs do. It exists only to show how this method
// fails; use closest_point() (point_triangle.h) instead.
//
// Source: Ericson, Real-Time Collision Detection, 2005, section 5.1.5. The method is correct in exact arithmetic. In
// double precision, its products of four lengths overflow for lengths beyond 2^255, underflow below 2^-268, and lose
// digits when they cancel. The error is as large as the triangle if the corners lie on a line or almost so, and 1e-12
// for points close to an ordinary triangle of size 1.
#pragma once

#include "algorithms/kernel/point_triangle.h"

namespace hausbench {

TrianglePoint textbook_closest_point(const Vec3& p, const Triangle& triangle);

}  // namespace hausbench
