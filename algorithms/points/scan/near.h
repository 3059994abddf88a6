// Steps 4 to 6 of scan.cpp, which describes them: compares the undecided points of A with the points of B near them.
#pragma once

#include "algorithms/kernel/deadline.h"
#include "algorithms/kernel/parallel.h"
#include "algorithms/points/scan/near_grid.h"
#include "algorithms/points/scan/search.h"

#include <vector>

namespace hausbench {

// The input of the steps for one query. They do not change it; their results are in ScanState.
struct ScanWork {
    const Query& query;
    const Deadline& deadline;
    Threads threads;
    const Points &a, &b;           // A moved by the pose of the query; B
    const NearGrid& grid;          // over B
    const Box& target_box;         // the box of B
    double cells_from, tree_from;  // numbers of pairs, see the parameters with these names in scan.cpp

    static constexpr std::size_t block_rows = 1024;  // rows of A that one thread takes at a time

    // Returns the reason why the search must stop now, or `converged` if it may go on.
    Status stop(const ScanState& state) const;
};

// A point of A that may still raise the largest distance.
struct Undecided {
    double squared;  // squared distance to some point of B, first to the candidate: an upper bound
    Index row;
};

// Returns a sample of `rows`, or of all rows of A if null: the first row of each of up to 1024 parts of equal size.
std::vector<Index> sample_of(const Points& a, const std::vector<Index>* rows);

// Decides all points of A by steps 5 and 6 with all points of B. Which of these steps run depends on |A| * |B|, the
// number of pairs. Updates `state`. Returns the reason if it had to stop early, otherwise `converged`.
Status search_all(const ScanWork& work, ScanState& state);

// Decides the undecided points of A by steps 4 to 6. Updates `state`, and returns the same as search_all().
Status search_undecided(const ScanWork& work, const std::vector<Undecided>& undecided, ScanState& state);

}  // namespace hausbench
