// The piece of an algebraic surface in a box, given by its linear enclosure there, and bounds of its distance from a
// point.
//
// All functions require UpwardRounding (kernel/interval.h).
#pragma once

#include "algorithms/kernel/interval_form.h"

namespace hausbench {

struct SurfacePiece {
    Box box;
    LinearForm form;  // encloses the polynomial over the box
};

// Returns a point near the point of the piece nearest to p; not proven.
Vec3 seed_on(const SurfacePiece& piece, const Vec3& p);

// Return bounds of the distance from p to any point of the piece; the box may be of any size. The error of the upper
// bound is first-order in the size of the box only if p sees the piece at a slant. Proof: for n of length 1 and any
// l, n.(y - c) = q.u with q = n r, and on the surface slope.u = -e, so q.u = (q - l slope).u - l e <= sum |q - l
// slope| + sup(-l e).
double distance_at_least(const SurfacePiece& piece, const Vec3& p);
double distance_at_most(const SurfacePiece& piece, const Vec3& p);

}  // namespace hausbench
