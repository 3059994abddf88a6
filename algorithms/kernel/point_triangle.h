// Finds the point of a triangle that is closest to a given point, and a proven lower bound on the distance. Degenerate
// triangles are handled as accurately as others.
#pragma once

#include "algorithms/kernel/triangle.h"

namespace hausbench {

// The point of a triangle that is closest to a query point p.
struct TrianglePoint {
    double squared_distance;  // squared_length(p - point), rounded after each operation
    Vec3 point;               // in the bounding box of the triangle, without any slack; no coordinate is -0
};

// Returns the point of the triangle closest to p. |Coordinates| may be up to 2^400. Triangles without area (segments,
// points) are allowed. The kernel for several triangles at a time (point_triangle-inl.h) returns the same bits.
//
// Method. The corners are named so that ab is the longest edge. Let e = b - a, let x_c e be the part of c - a along e,
// and h = (c - a) - x_c e the height of c over ab; the code makes h orthogonal to e a second time, because rounding
// leaves a part along e. In the plane of the triangle, the foot of the perpendicular from p is
//     a + x e + y h  =  (1 - x + y x_c - y) a  +  (x - y x_c) b  +  y c.
// This foot is a candidate for the closest point if none of the three weights is negative (in the code, `x` is the
// second weight). The other candidates are the closest points of the three edges. The nearest candidate is returned. No
// product of more than two lengths occurs. (The usual method, in textbook.h, has products of four lengths. On a thin
// triangle, with one very short edge or with an angle of almost 180 degrees, these err by the size of the triangle.)
//
// Error. Let u = 2^-53, M be the largest |coordinate| of p and the triangle, q the returned point (taken as exact), and
// d the exact distance from p to the triangle.
//
// The distance is not too small (proven): d <= |p - q| + 7uM, because q is within 7uM of a point of the triangle. For
// the foot, q = (w_a a + w_b b) + w_c c with w_b, w_c >= 0, fl(w_b + w_c) <= 1 and w_a = max(fl(fl(1 - w_b) - w_c), 0),
// all as computed.
//   - w_a takes two roundings of numbers of at most 1, so the sum of the weights differs from 1 by at most u. Divided
//     by their sum, the weights give a point of the triangle, which differs from q by at most uM in each coordinate.
//   - The three products err by u (w_a + w_b + w_c) M = uM in total, and the two sums by uM each.
// Together this is 4uM in each coordinate, plus terms of order u^2, and sqrt(3) * 4uM < 7uM. A point (1 - t) a + t b of
// an edge errs less. At the end, q is clamped to the box of the triangle; this moves q no farther from the point of the
// triangle, because that point lies in the box. The proof uses nothing else about the weights, so upper bounds hold
// however large the errors of x and y are.
//
// The distance is not too large (measured): |p - q| <= d + 10uM on millions of pairs of every degenerate class
// (tests/algorithms/kernel/kernel_point_triangle_test.cpp). Bounds are valid without this; it only makes them tight.
// The reason for so small an error: x e errs by a few uM, and so does y h, except that rounding c - a tilts h out of
// the plane by an angle of a few u |e| / |h|. The tilt moves the foot along h by at most u d |e| / |h|, and also by at
// most |h|, because weights outside [0, 1] are not used. If the foot moves by m within the plane, its distance grows by
// at most m^2 / (2d); here, this is at most u |e|. If x or y err so much that a foot inside the triangle seems to be
// outside, the closest point of an edge is just as near.
//
// The computed distance f = fl(sqrt(squared_distance)) errs by another 4u f (rounding.h).
TrianglePoint closest_point(const Vec3& p, const Triangle& triangle);

// Returns a proven lower bound on the exact distance from p to the triangle. It holds for any q, and is tight if q is
// the point that closest_point returned.
//
// Method. Let n be any vector except 0. Along n, every point of the triangle is at least as far from p as the nearest
// corner: the distance is at least min over corners v of n.(p - v) / |n|. The function returns the largest of these
// bounds for several n: p - q, its parts perpendicular to each edge, and the normal of the triangle.
//
// Rounding, for one corner. w = fl(p - v) errs by u |w_k| in coordinate k, and the products and sums by 3u, so the dot
// product m = n.w is off by at most 4.01u sum |n_k| |w_k| <= 4.01u |n| |w|. The length |n| errs by 2.5u, and the
// quotient by u. As |m| / |n| <= |w|, all this is less than 7.6u |w|, and the subtraction of the margin adds u |w|. As
// |w| <= |w_x| + |w_y| + |w_z|, the margin 9u max(|w_x| + |w_y| + |w_z|), over the three corners, is enough. Vectors n
// with |n| <= 2^-450 are not used; for others, underflow costs less than 2^-600, which is part of the margin, too.
double distance_certainly_at_least(const Vec3& p, const Triangle& triangle, const Vec3& q);

}  // namespace hausbench
