// Distances between the voxels of two surfaces. The distance of two voxels is an interval [g, G], the least and the
// largest distance of their points; the result is [max over A of min over B of g, max over A of min over B of G].
//
// Squared distances are rounded to nearest by monotone operations. If the budget or the time runs out, the results
// are too small, and `stopped` is set.
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

    // Checks the limits; `done` is in the unit of the budget.
    bool stop_after(std::uint64_t done) {
        if (done >= query.budget) stopped = Status::budget;
        if (deadline.passed()) stopped = Status::time_limit;
        return stopped.has_value();
    }
};

struct VoxelDistances {
    double least = 0, largest = 0;  // squared g and G
};

// Returns the squared G of two boxes.
double largest_squared_distance(const Box& a, const Box& b);

// Computes every pair. Budget: voxels of A.
VoxelDistances distances_of_all(const Voxels& a, const Voxels& b, VoxelWork& work);

// Computes the same bits from far fewer pairs. From one voxel of A to another, min over B of g grows by at most the
// distance between the two, because they are translates. So the octree over A is searched with the value at one voxel
// of each cell, and each value is found with the octree over B. Budget: such searches, one each for g and G.
VoxelDistances distances_by_search(const Voxels& a, const Voxels& b, VoxelWork& work);

}  // namespace hausbench
