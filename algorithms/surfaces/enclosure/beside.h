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

// Returns M / m, where M = `most` must be at least |f_B| on the piece. The box of the piece is widened along an axis k,
// by at least M / m, and m is a lower bound of |df_B/dx_k| in the widened box, which must lie in B's box. Then f_B has
// a zero, a point of B, within M / m of each point of the piece.
double within(const SurfaceTree::Node& piece, SurfaceTree& target, double most, Counters& counters);

// Returns within() with an M that is computed from the linear forms of both surfaces.
double next_to(const SurfaceTree::Node& piece, SurfaceTree& target, Counters& counters);

// Returns |t| for a vector t such that f_B has one sign on the piece, and the opposite sign on the piece moved by t.
// Then f_B has a zero within |t| of each point of the piece. `p` is a point of the piece and `foot` the point of B
// closest to it; tries t = foot - p and slightly longer vectors, as long as they are shorter than `known`.
double beside(const SurfaceTree::Node& piece, SurfaceTree& target, const Vec3& p, const Vec3& foot, double known,
              Counters& counters);

}  // namespace hausbench
