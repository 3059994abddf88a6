// Branch and bound over pieces of A, with one or several upper bounds for each piece. Shared by kang, zheng and sacht.
//
// A *piece* is a triangle of A or a part of one. The piece with the largest upper bound is split first. The lower bound
// is the largest distance to B of a point of A measured so far. If one triangle of B is nearest to all three corners of
// a piece, the distances of the corners give the exact bound. For any other piece the bounds in Cascade::order are
// computed in turn until one of them is at most the lower bound; this *settles* the piece, so it needs no further work.
// If none is, the piece is queued with the least of these bounds and the bound of the piece that it was split from.
// Ours: before a piece is queued, a second test looks for a triangle of B that is nearest to all corners, up to
// rounding. Identical meshes need this test: at a vertex of B, queries may return any triangle around it.
//
// Certified: upper bounds are widened for rounding as in search/piece_bounds.h and kernel/rounding.h; the lower bound
// is certified as in search/bounds.h.
//
// Certificate: the pieces of the search, each with the reason for its least bound (search/piece_cells.h). A piece that
// was settled by the bound of a larger piece is bounded again after the search (search/piece_proofs.h).
//
// Vertices of A that no triangle uses do not count. The search also ends when the queue is empty; the upper bound of
// h(A,B) is then the largest upper bound of a settled piece.
#pragma once

#include "algorithms/search/mesh_solver.h"

#include <limits>
#include <string>
#include <vector>

namespace hausbench {

enum class PieceBound { u1 = 1, u2, u3, u4, nearest_triangles };  // the bounds of PieceBounds (piece_bounds.h)

struct Cascade {
    std::vector<PieceBound> order;  // the upper bounds to compute, in this order
    Split split = Split::midpoint;
    // Limit on the number of triangles of A and pieces together, as a multiple of the number of triangles of A.
    double max_factor = std::numeric_limits<double>::infinity();
    bool regions = false;  // bound groups of triangles of A by boxes (search/source_regions.h)
    bool grid = false;     // find closest points of B with a uniform grid instead of a BVH
};

// Returns the description that kang, zheng and sacht share, with their parameters `split` and `regions`. The argument
// `regions` is the default of that parameter.
SolverInfo cascade_info(std::string name, std::string title, std::string paper, bool regions = false);

// Returns a cascade of these upper bounds, with `split` and `regions` from the options.
Cascade cascade_of(const Options& options, std::vector<PieceBound> order);

std::unique_ptr<Solver> cascade_solver(Cascade cascade);

}  // namespace hausbench
