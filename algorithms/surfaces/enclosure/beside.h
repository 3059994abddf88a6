// Upper bounds on the distance from a piece of A (the part of A in a box) to B. For each point of the piece they prove
// a point of B near it, instead of using one point of B for the whole piece. So they are tight if A and B nearly touch,
// or run side by side like concentric spheres.
//
// The caller of every function must hold an UpwardRounding (kernel/interval.h), which sets the rounding mode. The
// bounds are infinite at the sides of B's box, or if B curves too much. Each takes a few evaluations of the polynomial.
#pragma once

#include "algorithms/surfaces/surface_tree.h"

namespace hausbench::surface_enclosure {

// Returns an upper bound on the distance between two points.
double apart_at_most(const Vec3& a, const Vec3& b);

// Returns an upper bound on the distance from any point of the piece to B. |f_B| must be at most `most` on the piece,
// where f_B is the polynomial of B. Widens the box of the piece along one axis, and finds a lower bound m on |df_B/dx|
// along this axis in the widened box. If the box was widened by most / m or more, and lies in the box of B, then f_B
// has a zero, a point of B, within most / m of each point of the piece. Otherwise returns infinity.
double within(const SurfaceTree::Node& piece, SurfaceTree& target, double most, Counters& counters);

// Like within(), but computes `most` from the linear forms of both surfaces.
double next_to(const SurfaceTree::Node& piece, SurfaceTree& target, Counters& counters);

// Returns an upper bound on the distance from any point of the piece to B: the length of a vector t such that f_B has
// one sign on the piece and the opposite sign, or 0, on the piece moved by t. Then f_B has a zero between each point
// and its moved copy.
//
// Tries t = foot - p, where `p` is a point of the piece and `foot` the point of B closest to p, and slightly longer
// vectors. Returns infinity if none of them works or is shorter than `limit`.
double beside(const SurfaceTree::Node& piece, SurfaceTree& target, const Vec3& p, const Vec3& foot, double limit,
              Counters& counters);

}  // namespace hausbench::surface_enclosure
