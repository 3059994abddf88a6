// The piece of an algebraic surface in a box, by its linear enclosure there, and how far it is from a point.
//
// All functions want UpwardRounding (kernel/interval.h).
#pragma once

#include "algorithms/kernel/interval_form.h"

namespace hausbench {

struct SurfacePiece {
    Box box;
    LinearForm form;  // of the polynomial over the box
};

// About the point of a piece (box and linear enclosure) that is nearest to p; nothing is proven.
Vec3 seed_on(const SurfacePiece& piece, const Vec3& p);

// No point of the piece is nearer to p; and none, of any box, farther (a bound that is first-order in the box's size only
// where p sees the piece at a slant). Proof: for n of length 1 and any l, n.(y - c) = q.u with q = n r, and on the surface
// slope.u = -e, so q.u = (q - l slope).u - l e <= sum |q - l slope| + sup(-l e).
double distance_at_least(const SurfacePiece& piece, const Vec3& p);
double distance_at_most(const SurfacePiece& piece, const Vec3& p);

}  // namespace hausbench
