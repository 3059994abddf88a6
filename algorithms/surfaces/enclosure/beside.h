// Upper bounds of the distance from a piece of A to B that prove a point of B next to each point of the piece,
// instead of one point for all. They are tight if A and B nearly touch, or run side by side like concentric spheres.
//
// All functions require UpwardRounding (kernel/interval.h). They return infinity if they do not apply: at the sides
// of B's box, or if B curves too much. Each takes a few evaluations of the polynomial.
#pragma once

#include "algorithms/surfaces/surface_tree.h"

namespace hausbench {

// Returns an upper bound of the distance between two points.
double apart_at_most(const Vec3& a, const Vec3& b);

// Returns M / m, if |f_B| <= M = `most` over the piece, |df_B/dx_k| >= m over its box widened by t >= M / m along
// axis k, and the widened box lies in B's box. Then each point of the piece has a point of B within M / m.
double within(const SurfaceTree::Node& piece, SurfaceTree& target, double most, Counters& counters);

// Does the same with an M from the linear forms of both surfaces.
double next_to(const SurfaceTree::Node& piece, SurfaceTree& target, Counters& counters);

// Returns |t| for a vector t such that f_B has one sign on the piece and the opposite sign on the piece moved by t.
// Then each point of the piece has a zero of f_B within |t|. Tries t = foot - p, for a point p of the piece and its
// foot, and slightly longer vectors, up to the length `known`.
double beside(const SurfaceTree::Node& piece, SurfaceTree& target, const Vec3& p, const Vec3& foot, double known,
              Counters& counters);

}  // namespace hausbench
