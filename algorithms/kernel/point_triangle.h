// Closest point of a triangle, robust for degenerate ones, with a proven error.
#pragma once

#include "../scene.h"
#include "box.h"

namespace hausbench {

struct Triangle {
    Vec3 a, b, c;
};

inline Triangle triangle_of(const TriangleMesh& mesh, Index triangle) {
    const auto corners = mesh.triangles.row(triangle);
    return {mesh.vertices.row(corners[0]), mesh.vertices.row(corners[1]), mesh.vertices.row(corners[2])};
}

// Written out, so that the order of the sums is fixed.
inline double dot(const Vec3& x, const Vec3& y) { return (x[0] * y[0] + x[1] * y[1]) + x[2] * y[2]; }
inline double squared_length(const Vec3& x) { return dot(x, x); }

inline Box box_of(const Triangle& t) {
    Box box;
    box.low = t.a.cwiseMin(t.b).cwiseMin(t.c);
    box.high = t.a.cwiseMax(t.b).cwiseMax(t.c);
    return box;
}

struct TrianglePoint {
    double squared_distance;  // squared_length(p - point), as rounded
    Vec3 point;               // inside the box of the triangle, exactly
};

// The point of the triangle closest to p. Coordinates up to 2^400; zero-area triangles (segments, points) are fine.
//
// Method: the foot in the plane from the cross product of two edges, refined twice on the residual p - q; where it falls
// outside, or the triangle is a needle or a cap, the minimum over the segments too (after Ericson, Real-Time Collision
// Detection, 2005, section 5.1.5, whose version errs by the size of the triangle on needles and caps).
//
// Error. The returned point q is within 16 u M of the triangle, M = max |coordinate| of the triangle:
// q = a + (s (b-a) + t (c-a)) with s, t >= 0 in floating point, s <= 1, t <= fl(1 - s). In each coordinate |b-a|, |c-a|
// <= 2M; rounding the differences and the products costs 2u each, together 4uM(s+t); the sum 2uM; the last sum, whose
// result is at most M, uM; s + t may pass 1 by u/2, which moves q by uM: 8uM and terms of order u^2, below 9uM; sqrt(3) 9 < 16.
// Segments, q = a + t (b-a), err less. Clamping q to the triangle's box moves it no farther from the exact point, which
// lies in the box. So the exact distance is at most |p - q| + 16uM: an upper bound that needs no more proof. That q is
// also nearly the closest point is not proven here but checked where a lower bound hangs on it, by the next function.
TrianglePoint closest_point(const Vec3& p, const Triangle& triangle);

// A proven lower bound of the exact distance from p to the triangle; q is what closest_point returned, or any guess.
//
// For every n != 0, no point of the triangle is closer than min over vertices v of n.(p - v) / |n|. Several n are tried:
// p - q, its parts perpendicular to an edge, and the normal. Rounding: w = fl(p - v) errs by u|w_k| in each coordinate,
// the products and sums by 3u: the dot product is off by at most 4.01u sum |n_k||w_k| <= 4.01 u |n||w|; |n| is off by a
// factor 1 -+ 2.5u, the quotient by u more. So m/|n| (1 - 5u) - 6u max(|w_x| + |w_y| + |w_z|) is a lower bound. n with
// |n| < 2^-450 are not tried; underflow then costs less than 2^-600.
double distance_certainly_at_least(const Vec3& p, const Triangle& triangle, const Vec3& q);

}  // namespace hausbench
