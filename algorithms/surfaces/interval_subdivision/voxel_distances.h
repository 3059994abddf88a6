// The distances of two surfaces' voxels. That of two voxels is an interval [g, G], the least and the largest distance of their points; what is
// computed is [max over A of min over B of g, max over A of min over B of G].
//
// Squared distances are rounded to nearest, by monotone operations. What is left undone when the budget or the time runs out makes the results
// too small: `stopped` then says so.
#pragma once

#include "algorithms/kernel/deadline.h"
#include "algorithms/solver.h"
#include "algorithms/surfaces/interval_subdivision/voxels.h"

#include <optional>

namespace hausbench {

struct VoxelWork {
    const Query& query;
    const Deadline& deadline;
    Counters counters;
    std::optional<Status> stopped;

    // `done` is in the unit of the budget.
    bool stop_after(std::uint64_t done) {
        if (done >= query.budget) stopped = Status::budget;
        if (deadline.passed()) stopped = Status::time_limit;
        return stopped.has_value();
    }
};

struct VoxelDistances {
    double least = 0, largest = 0;  // squared g and G
};

// Squared G of two boxes.
double largest_squared_distance(const Box& a, const Box& b);

// Every pair. Budget: voxels of A.
VoxelDistances distances_of_all(const Voxels& a, const Voxels& b, VoxelWork& work);

// The same bits by far fewer pairs. min over B of g is at most the distance between voxels farther for another voxel of A (both are
// translates), so an octree over A is searched by the value at one voxel of each cell, and each value by an octree over B. Budget: such
// searches, of g and of G each.
VoxelDistances distances_by_search(const Voxels& a, const Voxels& b, VoxelWork& work);

}  // namespace hausbench
