// Steps 4 to 6 of points/scan/scan.cpp: compares the undecided points of A with the points of B near them.
#pragma once

#include "algorithms/kernel/deadline.h"
#include "algorithms/kernel/parallel.h"
#include "algorithms/points/scan/near_grid.h"
#include "algorithms/points/scan/search.h"

#include <vector>

namespace hausbench {

// The data of one query, with the shapes at its pose.
struct ScanWork {
    const Query& query;
    const Deadline& deadline;
    Threads threads;
    const Points &a, &b;
    const NearGrid& grid;          // over B
    const Box& target_box;         // the box of B
    double cells_from, tree_from;  // numbers of pairs; see the parameters of these names

    static constexpr std::size_t block_rows = 1024;  // rows of A that one thread takes at a time

    // Returns the reason to stop, or `converged` to go on.
    Status stop(const ScanState& state) const;
};

// A point of A that may still be farthest, with the squared distance of its candidate.
struct Undecided {
    double squared;
    Index row;
};

// Returns a sample of the rows (of all of A if null), one from each of up to 1024 parts.
std::vector<Index> sample_of(const Points& a, const std::vector<Index>* rows);

// Searches all of B for each point of A, by the cheapest method for this number of pairs. Returns why it stopped, as
// ScanWork::stop() does.
Status search_all(const ScanWork& work, ScanState& state);

// Searches the points of B that may be closest to the undecided points. Returns the same.
Status search_undecided(const ScanWork& work, const std::vector<Undecided>& undecided, ScanState& state);

}  // namespace hausbench
