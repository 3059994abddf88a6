// Upper bounds on the distance from a piece of A (the part of A in a box) to B. For each point of the piece they prove
// a point of B near it, instead of using one point of B for the whole piece. So they are tight if A and B nearly touch,
// or run side by side like concentric spheres.
//
// The caller of every function must hold an UpwardRounding (kernel/interval.h), which sets the rounding mode. The
// bounds are infinite where they do not apply: at the sides of B's box, or if B curves too much. Each takes a few
// evaluations of the polynomial.
#pragma once

#include "algorithms/surfaces/surface_tree.h"

namespace hausbench {

// Returns an upper bound on the distance between two points.
double apart_at_most(const Vec3& a, const Vec3& b);

// Returns an upper bound on the distance from any point of the piece to B, given that |f_B| <= `most` on the piece; f_B
// is the polynomial of B. If the box of the piece is widened along one axis by at least `most` / m, and |df_B/dx| >= m
// along this axis in the widened box, f_B has a zero within `most` / m of each point of the piece. The zero is a point
// of B if the widened box lies in the box of B.
double within(const SurfaceTree::Node& piece, SurfaceTree& target, double most, Counters& counters);

// Like within(), but computes a bound on |f_B| from the linear forms of both surfaces.
double next_to(const SurfaceTree::Node& piece, SurfaceTree& target, Counters& counters);

// Returns an upper bound on the distance from any point of the piece to B: the length of a vector t such that f_B has
// one sign on the piece and the opposite sign, or 0, on the piece moved by t. Then f_B has a zero between each point
// and its moved copy.
//
// Tries t = foot - p, where `p` is a point of the piece and `foot` the point of B closest to p, and slightly longer
// vectors. Gives up if t is not shorter than `known`.
double beside(const SurfaceTree::Node& piece, SurfaceTree& target, const Vec3& p, const Vec3& foot, double known,
              Counters& counters);

}  // namespace hausbench
