// Branch and bound over pieces of A with one upper bound per piece or several in turn; shared by kang, zheng and
// sacht.
//
// The piece with the largest upper bound is split first; the lower bound is the largest distance of a point of A
// measured so far. A piece whose corners share a nearest triangle is exact. For any other piece the bounds of `order`
// are computed in turn until one is at most the lower bound; otherwise the piece is queued with the least of its own
// bounds and its parent's.
// Ours: before a piece is queued, a second test checks whether ties hide a nearest triangle shared by its corners.
// Identical meshes need this test, because the nearest triangle of a vertex may be any triangle at that vertex.
//
// Certified: bounds are widened as in piece_bounds.h and kernel/rounding.h; the lower bound is computed as in
// bounds.h. Certificate: the search's own pieces, each with the argument of its least bound (search/piece_cells.h). A
// piece settled by the bound of a larger piece is bounded again after the search (search/piece_proofs.h).
// Vertices that no triangle of A uses never count. An empty queue ends the search; the bounds of removed pieces are
// kept.
#pragma once

#include "algorithms/search/mesh_solver.h"

#include <limits>
#include <string>
#include <vector>

namespace hausbench {

enum class PieceBound { u1 = 1, u2, u3, u4, nearest_triangles };  // as in piece_bounds.h

struct Cascade {
    std::vector<PieceBound> order;
    Split split = Split::midpoint;
    // Limit on the number of triangles and pieces per triangle of A.
    double max_factor = std::numeric_limits<double>::infinity();
    bool regions = false;  // search/source_regions.h
    bool grid = false;     // find closest points of B with a uniform grid instead of a BVH
};

// Returns the shapes, structures and parameters (`split` and `regions`) that the three solvers share.
SolverInfo cascade_info(std::string name, std::string title, std::string paper, bool regions = false);

Cascade cascade_of(const Options& options, std::vector<PieceBound> order);

std::unique_ptr<Solver> cascade_solver(Cascade cascade);

}  // namespace hausbench
