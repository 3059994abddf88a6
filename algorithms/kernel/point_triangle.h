// Closest point of a triangle; robust for degenerate triangles, with a proven error.
#pragma once

#include "algorithms/kernel/triangle.h"

namespace hausbench {

struct TrianglePoint {
    double squared_distance;  // squared_length(p - point), as rounded
    Vec3 point;               // exactly inside the box of the triangle; no coordinate is -0
};

// Returns the point of the triangle closest to p. Coordinates may be up to 2^400; zero-area triangles (segments,
// points) are fine. The kernel for eight triangles at a time (point_triangle-inl.h) returns the same bits.
//
// Method: the longest edge e = b - a comes first. Its height is h = (c - a) - x_c e, made orthogonal to e twice.
// The foot of p in the plane has the coordinates x along e and y along h, so its weights are 1 - x + y x_c - y,
// x - y x_c and y; the foot is a candidate if no weight is negative. The nearest candidate among the foot and the
// closest points of the three edges wins. No product of more than two lengths occurs. (textbook.h has the method of
// Ericson, Real-Time Collision Detection, 2005, section 5.1.5; on needles and caps its products of four lengths err
// by the size of the triangle.)
//
// Error: u = 2^-53, M = max |coordinate| of p and the triangle, q is the returned point taken as exact, d is the
// exact distance.
//
// Not too near (proven): d <= |p - q| + 7uM. q = (w_a a + w_b b) + w_c c has w_b, w_c >= 0 in floating point with
// fl(w_b + w_c) <= 1, and w_a = max(fl(fl(1 - w_b) - w_c), 0). These are two roundings of numbers of at most 1, so
// the weights add up to 1 within u. Let w_a absorb that difference or, if w_a = 0, divide all weights by their sum:
// q moves by at most uM in each coordinate. Products cost u (w_a + w_b + w_c) M = uM, and the two sums uM each.
// Together this is 4uM plus terms of order u^2, and sqrt(3) 4 < 7. A point (1 - t) a + t b of an edge errs less.
// Clamping q to the triangle's box moves it no farther from the feasible point, which lies in the box. Nothing else
// is required of q: upper bounds hold whatever the errors of x and y.
//
// Not too far (measured): |p - q| <= d + 10uM on millions of pairs of every degenerate class
// (tests/algorithms/kernel/kernel_point_triangle_test.cpp). Bounds hold without this; it only makes them tight. The
// error is so small for this reason: x e errs by a few uM, and so does y h except for the tilt of h out of the
// plane, which is an angle of a few u|e|/|h| from rounding c - a. The tilt moves the foot along h by at most u d
// |e|/|h|, and by at most |h| because the weights are clamped; moving it by m along the plane costs m^2 / 2d, at
// most u|e|. If the errors of x or y are so large that an inside point is taken for outside, the closest point of
// an edge is just as near.
//
// The computed distance f = fl(sqrt(squared_distance)) errs by another 4u f (rounding.h).
TrianglePoint closest_point(const Vec3& p, const Triangle& triangle);

// Returns a proven lower bound of the exact distance from p to the triangle; q is the point that closest_point
// returned, or any other point.
//
// For every n != 0, no point of the triangle is closer to p than min over vertices v of n.(p - v) / |n|. Several n
// are tried: p - q, its parts perpendicular to an edge, and the normal. Rounding: w = fl(p - v) errs by u|w_k| in
// each coordinate, the products and sums by 3u, so the dot product m is off by at most
// 4.01u sum |n_k||w_k| <= 4.01u |n||w|. |n| is off by a factor of 1 -+ 2.5u, and the quotient by another u. |m|/|n|
// is at most |w|, so all this is less than 7.6u |w|, and the subtraction adds u. |w| <= |w_x| + |w_y| + |w_z|, so
// m/|n| - 9u max(|w_x| + |w_y| + |w_z|) is a lower bound. Directions with |n| < 2^-450 are not tried; underflow
// then costs less than 2^-600.
double distance_certainly_at_least(const Vec3& p, const Triangle& triangle, const Vec3& q);

}  // namespace hausbench
