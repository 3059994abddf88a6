// Branch and bound over pieces of A, with one upper bound for a piece or several in turn: kang, zheng and sacht.
//
// The piece of largest upper bound is split first; the lower bound is the largest distance of a point of A met so far. A piece
// whose corners share a nearest triangle is exact. For any other piece the bounds of `order` are computed in turn, until
// one does not exceed the lower bound; otherwise it goes into the queue with the least of its bounds and its parent's.
// Ours: before a piece goes into the queue, a second test finds out whether ties hide a nearest triangle that its corners share.
// Identical meshes need this, because the nearest triangle of a vertex may be any of those around it.
//
// Certified: piece_bounds.h and kernel/rounding.h say how bounds are widened; the lower bound is that of bounds.h.
// Certificate: the search's own pieces, each with the argument of its least bound (search/piece_cells.h). A piece settled by the bound
// of a larger piece is bounded again after the search (search/piece_proofs.h).
// Vertices that no triangle of A uses never count. An empty queue ends the search; removed pieces have kept their bounds.
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
    // The most triangles and pieces per triangle of A.
    double max_factor = std::numeric_limits<double>::infinity();
    bool regions = false;  // search/source_regions.h
    bool grid = false;     // closest points of B are found by a uniform grid, not by a BVH
};

// Returns the shapes, structures and parameters (`split` and `regions`) that the three solvers share.
SolverInfo cascade_info(std::string name, std::string title, std::string paper, bool regions = false);

Cascade cascade_of(const Options& options, std::vector<PieceBound> order);

std::unique_ptr<Solver> cascade_solver(Cascade cascade);

}  // namespace hausbench
