// Steps 4 to 6 of points/scan/scan.cpp: the points of A that are left, against what is near them of B.
#pragma once

#include "algorithms/kernel/deadline.h"
#include "algorithms/kernel/parallel.h"
#include "algorithms/points/scan/near_grid.h"
#include "algorithms/points/scan/search.h"

#include <vector>

namespace hausbench {

// One query, with the shapes at its pose.
struct ScanWork {
    const Query& query;
    const Deadline& deadline;
    Threads threads;
    const Points &a, &b;
    const NearGrid& grid;          // over B
    const Box& target_box;         // of B
    double cells_from, tree_from;  // pairs, see the parameters of these names

    static constexpr std::size_t block_rows = 1024;  // of A, that one thread takes at a time

    // Why to stop; `converged`: go on.
    Status stop(const ScanState& state) const;
};

// A point of A that may still be the farthest one, and the squared distance of its candidate.
struct Undecided {
    double squared;
    Index row;
};

// Some of the rows (of all of A if null), one of each of up to 1024 parts.
std::vector<Index> sample_of(const Points& a, const std::vector<Index>* rows);

// All points of A against all of B, with what is cheapest for so many; both end as ScanWork::stop() does.
Status search_all(const ScanWork& work, ScanState& state);

// The undecided ones against the points of B that may be closest to them.
Status search_undecided(const ScanWork& work, const std::vector<Undecided>& undecided, ScanState& state);

}  // namespace hausbench
