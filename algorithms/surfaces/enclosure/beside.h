// Upper bounds on the distance from a piece of A to B that prove a point of B next to each point of the piece, instead of one point for
// all. They are close if A and B nearly touch, or run side by side like concentric spheres.
//
// All functions require UpwardRounding (kernel/interval.h). They return infinity if they do not apply: at the sides of B's box, or if B
// curves too much. Each takes a few evaluations of the polynomial.
#pragma once

#include "algorithms/surfaces/surface_tree.h"

namespace hausbench {

// Returns an upper bound of the distance of two points.
double apart_at_most(const Vec3& a, const Vec3& b);

// If |f_B| <= M over the piece and |df_B/dx_k| >= m over its box widened by t >= M / m along axis k, and the widened box lies
// in B's box, then a point of B lies within M / m of each point of the piece. `most` is M.
double within(const SurfaceTree::Node& piece, SurfaceTree& target, double most, Counters& counters);

// The same, with an M from the linear forms of both surfaces.
double next_to(const SurfaceTree::Node& piece, SurfaceTree& target, Counters& counters);

// If f_B has one sign on the piece and the opposite sign on the piece moved by t, a zero lies within |t| of each point. Tries
// t = foot - p, for a point p of the piece and its foot, and slightly longer ones, up to the length `known`.
double beside(const SurfaceTree::Node& piece, SurfaceTree& target, const Vec3& p, const Vec3& foot, double known,
              Counters& counters);

}  // namespace hausbench
