// A *piece* is the part of an algebraic surface in a box. It is described by a linear form that encloses the polynomial
// over the box (kernel/interval_form.h). The linear form gives bounds on the distance from a point to the piece.
//
// The caller of every function must hold an UpwardRounding (kernel/interval.h), which sets the rounding mode.
#pragma once

#include "algorithms/kernel/interval_form.h"

namespace hausbench {

struct SurfacePiece {
    Box box;
    LinearForm form;  // encloses the polynomial over the box
};

// Returns an estimate of the point of the piece nearest to p: a starting point for searches, which need not
// lie on the surface.
Vec3 seed_on(const SurfacePiece& piece, const Vec3& p);

// Return a lower bound on the distance from p to the nearest point of the piece, and an upper bound on the distance to
// its farthest point. The box may be of any size. The error of the upper bound is of second order in the size of the
// box, or of first order if p sees the piece at a slant, not head-on.
//
// Proof. Let c, r and slope be as in LinearForm: for a point y = c + r u of the box, with |u| <= 1 (componentwise), f
// is slope.u + e with some e in `rest`. So on the surface, slope.u = -e. Take any vector n (the code divides by its
// length at the end) and any number l. With q = n r, componentwise,
//     n.(y - c) = q.u = (q - l slope).u + l slope.u = (q - l slope).u - l e <= sum_k |q_k - l slope_k| + sup(-l e).
// This bounds how far the piece extends from c in the direction n.
double distance_at_least(const SurfacePiece& piece, const Vec3& p);
double distance_at_most(const SurfacePiece& piece, const Vec3& p);

}  // namespace hausbench
