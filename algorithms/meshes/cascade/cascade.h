// Branch and bound over pieces of A, with one upper bound for a piece or several in turn: kang, zheng and sacht.
//
// The piece of largest upper bound is split first; the lower bound is the largest distance of a point of A met so far. A piece
// whose corners have one nearest triangle in common is exact. For any other the bounds of `order` are computed in turn, until
// one does not exceed the lower bound; otherwise it goes into the queue with the least of them and of its parent's.
// Ours: a piece that would go into the queue is looked at once more, whether ties hide that its corners have a nearest triangle in
// common. Identical meshes need it: the triangle named for a vertex is any of those around it.
//
// Certified: piece_bounds.h and kernel/rounding.h say how the bounds are widened; the lower bound as in bounds.h.
// Certificate: the search's own pieces, each with the argument of its least bound (search/piece_cells.h); where it was settled by that of
// a larger piece, it is looked at once more when the search is over (search/piece_proofs.h).
// Vertices that no triangle of A uses never count, and an empty queue is the end: what left it has kept its bound.
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
    // At most so many triangles and pieces, for each triangle of A.
    double max_factor = std::numeric_limits<double>::infinity();
    bool regions = false;  // search/regions.h
    bool grid = false;     // closest points of B are found by a uniform grid, not by a BVH
};

// What the solvers have in common: shapes, structures, and the parameters `split` and `regions`.
SolverInfo cascade_info(std::string name, std::string title, std::string paper, bool regions = false);

Cascade cascade_of(const Options& options, std::vector<PieceBound> order);

std::unique_ptr<Solver> cascade_solver(Cascade cascade);

}  // namespace hausbench
