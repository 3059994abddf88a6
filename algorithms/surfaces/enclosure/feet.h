// An upper bound on the distance from a piece of A (the part of A in a box) to B. The *foot* of a point of A is the
// point of B closest to it. This bound follows the feet: it moves each point y of the piece by its own vector t(y),
// approximately to its foot, whereas beside.h moves all points by the same vector. The error falls with the ninth power
// of the size of the piece. So boxes need not shrink to the square root of the tolerance if the distance is nearly
// constant over A (concentric spheres, tori around one circle, cylinders around one axis).
//
// Proof. Let y be a point of the piece X, so f_A(y) = 0.
// 1. A is a graph over X. Let x_k be one coordinate, and (u, v) the other two, scaled so that X lies over [-1, 1]^2.
//    Let P be a polynomial in (u, v), let M >= |f_A(u, v, P(u, v))|, and let |df_A/dx_k| >= m > 0 in the box of X,
//    extended along axis k to include the values of P. By the mean value theorem along axis k,
//    |y_k - P(u, v)| <= M / m. So y lies in the Taylor model Y(u, v) whose coordinate k is P with the error M / m.
// 2. Let t be three polynomials in (u, v). If f_B has one sign on Y, and is 0 or has the other sign on Y + t, then the
//    segment from y to y + t(u, v) contains a zero of f_B. If both ends lie in B's box, so does the segment, because a
//    box is convex. The zero is then a point of B, so the distance from y to B is at most max |t(u, v)|.
//
// Newton's method finds P and t in plain arithmetic, degree by degree; the proof holds for any polynomials. If Y + t
// does not reach past B, t is made slightly longer. If f_B has both signs on Y, A and B meet or nearly meet there. The
// bound is then within() of beside.h, with M >= |f_B| on Y; X and the segments along that axis must lie in B's box.
//
// TaylorModel::at_most() bounds the maximum of |t|^2. Its error is of third order if the distance has a maximum on A.
#pragma once

#include "algorithms/surfaces/surface_tree.h"

namespace hausbench::surface_enclosure {

// Returns an upper bound on the distance from any point of the piece, which belongs to `source`, to `target`. Newton's
// method starts from `p`, a point near the piece, and `foot`, a point near the point of B closest to p.
//
// Returns infinity if the proof fails: if the piece is not proven to be a graph, if a segment may leave the box of B,
// or if B curves too much. To save time, also returns infinity once the bound cannot be below `limit`. The caller must
// hold an UpwardRounding. Takes about 25 evaluations of each polynomial in Taylor models.
double along_feet(const SurfaceTree::Node& piece, SurfaceTree& source, SurfaceTree& target, const Vec3& p,
                  const Vec3& foot, double limit, Counters& counters);

}  // namespace hausbench::surface_enclosure
