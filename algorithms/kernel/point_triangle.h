// Closest point of a triangle, robust for degenerate ones, with a proven error.
#pragma once

#include "algorithms/kernel/triangle.h"

namespace hausbench {

struct TrianglePoint {
    double squared_distance;  // squared_length(p - point), as rounded
    Vec3 point;               // inside the box of the triangle, exactly; no coordinate is -0
};

// The point of the triangle closest to p. Coordinates up to 2^400; zero-area triangles (segments, points) are fine.
// The kernel for eight triangles at a time (point_triangle-inl.h) returns the same bits.
//
// Method: with the longest edge e = b - a first, its height h = (c - a) - x_c e, made orthogonal to e twice. The foot in
// the plane has the coordinates x along e and y along h, so the weights 1 - x + y x_c - y, x - y x_c and y; it counts
// where none is negative. The nearest of it and of the closest points of the three edges wins. No product of more than
// two lengths occurs. (Ericson, Real-Time Collision Detection, 2005, section 5.1.5, is textbook.h; its products of four
// lengths err by the size of the triangle on needles and caps.)
//
// Error, u = 2^-53, M = max |coordinate| of p and the triangle, q the exact point returned, d the exact distance.
//
// Not too near, proven: d <= |p - q| + 7uM. q = (w_a a + w_b b) + w_c c has w_b, w_c >= 0 in floating point with fl(w_b +
// w_c) <= 1, and w_a = max(fl(fl(1 - w_b) - w_c), 0): two roundings of numbers of at most 1, so the weights add up to 1
// within u, and q moves by uM at most in each coordinate if w_a absorbs that (or, where w_a = 0, if all are divided by
// their sum). Products cost u(w_a + w_b + w_c)M = uM, the two sums uM each. Together 4uM and terms of order u^2; sqrt(3) 4
// < 7. A point (1 - t) a + t b of an edge errs less. Clamping q to the triangle's box moves it no farther from the
// feasible point, which lies in the box. Nothing else is asked of q: that upper bounds hold does not rest on x or y.
//
// Not too far, which is not needed for bounds to hold, only for them to be tight: |p - q| <= d + 10uM is measured, on
// millions of pairs of every degenerate class (tests/algorithms/kernel/kernel_point_triangle_test.cpp). Why it is so small: x e errs by a few
// uM, and so does y h but for the tilt of h out of the plane, by an angle of a few u|e|/|h| from rounding c - a. The tilt
// moves the foot along h by no more than u d |e|/|h|, and by no more than |h|, as the weights are clamped; to move it by m
// along the plane costs m^2 / 2d, at most u|e|. Where x or y errs so much that inside is taken for outside, the closest
// point of an edge is as near as that too.
//
// The computed distance f = fl(sqrt(squared_distance)) errs by another 4u f (rounding.h).
TrianglePoint closest_point(const Vec3& p, const Triangle& triangle);

// A proven lower bound of the exact distance from p to the triangle; q is what closest_point returned, or any point.
//
// For every n != 0, no point of the triangle is closer than min over vertices v of n.(p - v) / |n|. Several n are tried:
// p - q, its parts perpendicular to an edge, and the normal. Rounding: w = fl(p - v) errs by u|w_k| in each coordinate,
// the products and sums by 3u: the dot product m is off by at most 4.01u sum |n_k||w_k| <= 4.01 u |n||w|; |n| is off by a
// factor 1 -+ 2.5u, the quotient by u more. m/|n| is at most |w|, so all this is less than 7.6u |w|, and the subtraction
// adds u. |w| <= |w_x| + |w_y| + |w_z|: m/|n| - 9u max(|w_x| + |w_y| + |w_z|) is a lower bound. n with |n| < 2^-450 are
// not tried; underflow then costs less than 2^-600.
double distance_certainly_at_least(const Vec3& p, const Triangle& triangle, const Vec3& q);

}  // namespace hausbench
