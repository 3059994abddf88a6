// The closest point of a triangle as textbooks and most programs compute it. Kept to show its failures; use
// point_triangle.h instead.
//
// Ericson, Real-Time Collision Detection, 2005, section 5.1.5. Correct in exact arithmetic. In double, its products
// of four lengths overflow beyond 2^255, underflow below 2^-268, and cancel: on needles, caps and collinear corners
// it errs by the size of the triangle, and close to a triangle of size 1 by 1e-12.
#pragma once

#include "algorithms/kernel/point_triangle.h"

namespace hausbench {

TrianglePoint textbook_closest_point(const Vec3& p, const Triangle& triangle);

}  // namespace hausbench
