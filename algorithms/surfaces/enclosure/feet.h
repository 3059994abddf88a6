// An upper bound on the distance from a piece of A to B that follows the feet: every point y of the piece is moved by a
// vector t(y) of its own, to about its nearest point of B, where beside.h moves all of them by one vector. Its error
// shrinks with the ninth power of the piece, so that boxes need not shrink to the root of the tolerance where the distance
// is constant or nearly so over A (concentric spheres, tori around one circle, cylinders around one axis).
//
// Proof. Let y in the piece X satisfy f_A(y) = 0.
// 1. A is a graph. Let x_k be one coordinate and (u, v) the other two, scaled so that X lies over [-1, 1]^2, P a polynomial
//    in (u, v), M >= |f_A(u, v, P(u, v))|, and |df_A/dx_k| >= m > 0 over the box of X widened along axis k by the values of P.
//    By the mean value theorem along axis k, |y_k - P(u, v)| <= M / m. So y lies in a Taylor model Y(u, v).
// 2. Let t be three polynomials in (u, v). If f_B has one sign on Y, and is 0 or has the other sign on Y + t, then the segment
//    from y to y + t(y) holds a zero of f_B. If both ends lie in B's box, all of the segment does, because a box is convex.
//    That zero is a point of B, at most |t(y)| from y: the distance from y to B is at most max |t(u, v)|.
// P and t are found by Newton's method in plain arithmetic, degree by degree: they need no proof of their own. t is made a
// little longer than the way to B, so that its end is surely past B.
// Both may be any polynomials, so that a component of t that is rounding alone is made 0: Y + t then stays in a box that Y
// touches from inside, as coaxial cylinders need it.
// Where f_B has both signs on Y, the bound is within() of beside.h with M >= |f_B| on Y; X and the way lie in B's box.
//
// The maximum of |t|^2 is bounded by TaylorModel::at_most(), which is sharp to third order where the distance has a maximum
// on A. The lower bound of the solver needs nothing of this: it is the distance from one proven point.
#pragma once

#include "algorithms/surfaces/surface_tree.h"

namespace hausbench {

// No point of the piece of `source` is farther from `target`. Starts from a point p near the piece and a point near its foot.
// Infinity where A is no graph over the piece, where B's box may be left, or where B turns too much; gives up early
// where the bound cannot be below `known`. Wants UpwardRounding. About 25 evaluations of each polynomial in Taylor models.
double along_feet(const SurfaceTree::Node& piece, SurfaceTree& source, SurfaceTree& target, const Vec3& p,
                  const Vec3& foot, double known, Counters& counters);

}  // namespace hausbench
