// An upper bound of the distance from a piece of A to B that follows the feet: it moves each point y of the piece by
// its own vector t(y) to about the nearest point of B, whereas beside.h moves all points by one vector. Its error
// shrinks with the ninth power of the size of the piece, so boxes need not shrink to the square root of the tolerance
// if the distance is nearly constant over A (concentric spheres, tori around one circle, cylinders around one axis).
//
// Proof. Let y in the piece X satisfy f_A(y) = 0.
// 1. A is a graph. Let x_k be one coordinate and (u, v) the other two, scaled so that X lies over [-1, 1]^2. Let P be
//    a polynomial in (u, v), M >= |f_A(u, v, P(u, v))|, and |df_A/dx_k| >= m > 0 over the box of X widened along axis
//    k by the values of P. By the mean value theorem along axis k, |y_k - P(u, v)| <= M / m. So y lies in a Taylor
//    model Y(u, v).
// 2. Let t be three polynomials in (u, v). If f_B has one sign on Y, and is 0 or has the other sign on Y + t, then
//    the segment from y to y + t(y) contains a zero of f_B. If both ends lie in B's box, so does the segment, because
//    a box is convex. This zero is a point of B at most |t(y)| from y, so the distance from y to B is at most max
//    |t(u, v)|.
// Newton's method finds P and t in plain arithmetic, degree by degree; the proof holds for any polynomials. t is made
// slightly longer than the distance to B, so that its end is past B.
// A component of t that is only rounding noise is set to 0, so that Y + t stays in a box that Y touches from inside,
// as coaxial cylinders require.
// If f_B has both signs on Y, the bound is within() of beside.h with M >= |f_B| on Y; X and the segments must lie in
// B's box.
//
// TaylorModel::at_most() bounds the maximum of |t|^2, to third order if the distance has a maximum on A. The solver's
// lower bound is independent of this: it is the distance from one proven point.
#pragma once

#include "algorithms/surfaces/surface_tree.h"

namespace hausbench {

// Returns an upper bound of the distance from the piece of `source` to `target`. Starts from a point p near the piece
// and a point near its foot. Returns infinity if A is not a graph over the piece, if a segment may leave B's box, or
// if B curves too much; gives up early if the bound cannot be below `known`. Requires UpwardRounding. About 25
// evaluations of each polynomial in Taylor models.
double along_feet(const SurfaceTree::Node& piece, SurfaceTree& source, SurfaceTree& target, const Vec3& p,
                  const Vec3& foot, double known, Counters& counters);

}  // namespace hausbench
