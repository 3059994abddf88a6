// Steps 4 to 6 of the solver in scan.cpp: compares the points of A that may still raise the largest distance with the
// points of B near them.
#pragma once

#include "algorithms/kernel/deadline.h"
#include "algorithms/kernel/parallel.h"
#include "algorithms/points/scan/near_grid.h"
#include "algorithms/points/scan/search.h"

#include <vector>

namespace hausbench::scan {

// The input of steps 4 to 6 of scan.cpp for one query. Their results are in ScanState.
struct Work {
    const Query& query;
    const Deadline& deadline;
    Threads threads;
    const Points &a, &b;  // A, moved by the pose of the query, and B
    const NearGrid& grid;
    const Box& target_box;
    double cells_from, tree_from;  // numbers of pairs: the parameters with these names in scan.cpp

    static constexpr std::size_t block_rows = 1024;  // rows of A that one thread takes at a time

    // Returns the reason why the search must stop now, or `converged` if it may go on.
    Status stop(const ScanState& state) const;
};

// A point of A that may still raise the largest distance.
struct Undecided {
    double squared;  // squared distance to some point of B, so an upper bound
    Index row;
};

// Returns up to 1024 of the given rows of A (of all rows if null), evenly spaced.
std::vector<Index> sample_of(const Points& a, const std::vector<Index>* rows);

// Finds the largest distance from any point of A to B with steps 5 and 6 of scan.cpp, and stores it in `state`. Returns
// `converged`, or the reason if the search had to stop early.
Status search_all(const Work& work, ScanState& state);

// Like search_all(), but only for the undecided points of A, with steps 4 to 6 of scan.cpp.
Status search_undecided(const Work& work, const std::vector<Undecided>& undecided, ScanState& state);

}  // namespace hausbench::scan
