// The error of the distances that fields.cpp computes.
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"
#include "harness/ask/fields.h"

#include <algorithm>

namespace hausbench {

// Notation: u = 2^-53 is the unit roundoff, and M the largest |coordinate| of both shapes in their poses. Lengths are
// at most S = 2 * sqrt(3) * M < 3.47M. Constants are rounded up to cover terms of order u^2.
//
// Positions of vertices added by cuts. Rounding moves the midpoint of two vertices by sqrt(3) * uM, so its distance
// from its triangle is at most that plus the mean of the distances of the two vertices. A piece is cut only if its
// longest edge is longer than the resolution, which is at least 4 * 320uM = 1280uM. So about log2(S / 1280uM) < 44.5
// cuts precede a vertex, which costs 77uM. A witness is off by at most field_error(M) = 320uM. The sum is below 2 *
// field_error(M) = 640uM.
//
// Distances. Both shapes are scaled by a power of two, so that M is in [0.5, 1): coordinates that underflow are off by
// 2^-1075, which is negligible compared with uM, and so is the distance when it is scaled back.
//
// Let p be a vertex, T = abc a triangle of B whose longest edge is e = b - a, d the exact distance from p to T, and q
// the point that closest_point (point_triangle.cpp, whose names are used here) returns. q is within 7uM of T, so
// |p - q| >= d - 7uM. The steps below derive the other side, |p - q| <= d + 271uM. (Tests have found at most 10uM.)
//
// 1. Closest points of edges. Dot products of two computed differences err by 5.1u times both lengths; squares of
//    lengths have the relative error 5.1u, and their inverses 6.2u. So on an edge of length l, the position
//    along * inverse of the point nearest to p errs by 12.4u * S / l. This moves the point by 12.4uS, and rounding the
//    point moves it by 6uM: it is within d_edge + 49.1uM of p, where d_edge is the distance from p to the edge. (If
//    l < 2^-500, where squares underflow, every point of the edge is that near.) If the point of T nearest to p is on
//    an edge, d_edge is d for this edge, so a point within d + 49.1uM is found. Otherwise the nearest point is the foot
//    of the perpendicular from p; let it be a + X * e + Y * h, where h is the height over e.
// 2. If |h| <= 46uS (T is thin): the line along h through the nearest point crosses T on a length of at most
//    |h| < 160uM. So an edge is within 80uM of this point, and step 1 finds a point within d + 80uM + 49.1uM of p.
// 3. If |h| > 46uS: let f = c - a. x_c = f.e / e.e, the position along e at which h begins, errs by 12.4u, and
//    f - x_c * e is rounded by 4.1u|e|. So h after its first step is off by 4.1u|e| across e and by 16.5u|e| along e.
//    The second step leaves an error of 5.3u|h| + 230u^2 * |e| < 10.3u|h| along e and of b = 5.2u|e| < 0.113|h| across
//    e. The error of y = h.ap / h.h, times |h|, is the sum of
//       6u|e|                   from b in the plane of T, where ap has the part Y|h| along h
//       13.1u|e|                from the error left along e, where ap has the part X|e|
//       r = 6.7u * d|e| / |h|   from b out of the plane, where ap has the part d: h is tilted
//       9.5uS                   from rounding the two dot products and the quotient
//    The error of x + y * x_c, times |e|, is the sum of 12.4uS from step 1, 12.4u * y|e| from x_c, and 2.1uS
//    (if y <= 1) from the product and the difference.
// 4. If the weights are accepted: y <= 1, so the computed foot is off by (12.4 + 12.4 + 2.1)uS = 26.9uS along e and by
//    (6 + 13.1 + 9.5)uS + r = 28.6uS + r along h. Two points of T are at most |h| apart along h, so r counts only as
//    r' <= min(r, |h|), and it adds at most sqrt(d^2 + r'^2) - d <= r|h| / 2d < 3.4uS. As
//    sqrt(26.9^2 + 28.6^2) + 3.4 < 42.7, and the point is rounded by 7uM, |p - q| <= d + 42.7uS + 7uM < d + 156uM.
// 5. If the weights are rejected: the computed foot is outside T, so the segment from the exact foot to it crosses an
//    edge, after a fraction s of its length. As s|y - Y| <= 1, hence s * y <= 2, the part of the segment up to the edge
//    is at most (12.4 + 24.8 + 5.2)uS = 42.4uS long along e, and 28.6uS + r long along h. As
//    sqrt(42.4^2 + 28.6^2) + 3.4 < 54.6, an edge is within d + 54.6uS of p, and step 1 finds a point within d + 54.6uS
//    + 49.1uM < d + 239uM.
// 6. The candidate with the smallest computed square wins. The roots of computed squares err by at most 7.1u relative
//    to each other, 25uM. Then q is moved into the box of T, by at most its distance from T, 7uM. 239 + 25 + 7 = 271.
//
// Over all triangles, again the smallest computed square wins, which costs 25uM, and its triangle is within 7uM of q:
// 271uM + 25uM + 7uM = 303uM. Computing the distance from p to q errs by 4u * S < 14uM. 320uM covers the sum, 317uM.
// Coordinates and distances that are scaled back to subnormal numbers are off by less than 2^-1072.
double field_error(double magnitude) {
    return WATCHED("fields: the error of a distance", 320 * unit_roundoff * magnitude) + 0x1p-1072;
}

// The steps above hold with M for B and p alone, in scaled coordinates below 1, if M >= 2^-440: a square that underflows
// is less than 2^-1022, so the length is less than 2^-511, and in step 2 or 3 |h| is compared with more than 2^-493.
// If M < 2^-440, B and p are in a box with a diagonal below 2^-438, and so is q. 2^-438 in scaled coordinates is at most
// 2^-437 * largest; it also covers coordinates that underflow.
double field_error(const Vec3& vertex, double magnitude, double largest) {
    return field_error(
               std::max(magnitude, WATCHED("fields: the error of a far vertex", vertex.cwiseAbs().maxCoeff()))) +
           WATCHED("fields: squares that underflow beside a far vertex", 0x1p-437 * largest);
}

}  // namespace hausbench
