// Distances between the voxels of two surfaces. The distance of two voxels is an interval [g, G]: the least and the
// largest distance between a point of one and a point of the other. The result is [max over A of min over B of g,
// max over A of min over B of G].
//
// Squared distances are rounded to nearest by monotone operations. If the budget or the time runs out,
// VoxelWork::stopped is set, and the results are too small, because they are maxima over a part of A only.
#pragma once

#include "algorithms/kernel/deadline.h"
#include "algorithms/solver.h"
#include "algorithms/surfaces/interval_subdivision/voxels.h"

#include <optional>

namespace hausbench {

// The limits of a query, and the work done so far.
struct VoxelWork {
    const Query& query;
    const Deadline& deadline;
    Counters counters;
    std::optional<Status> stopped;

    // Returns whether to stop, and sets `stopped` to the reason. `done` is the work done, in the unit of the budget.
    bool stop_after(std::uint64_t done) {
        if (done >= query.budget) stopped = Status::budget;
        if (deadline.passed()) stopped = Status::time_limit;
        return stopped.has_value();
    }
};

struct VoxelDistances {
    double least = 0, largest = 0;  // g and G, squared
};

// Returns the square of G for two boxes.
double largest_squared_distance(const Box& a, const Box& b);

// Computes the distance of every pair of voxels. Unit of the budget: voxels of A.
VoxelDistances distances_of_all(const Voxels& a, const Voxels& b, VoxelWork& work);

// Computes the same bits from far fewer pairs. All voxels of A are translates of each other. So from one voxel of A to
// another, min over B of g grows by at most the length of the translation, and so does min over B of G. The search
// therefore computes these values for one voxel of a cell of A's octree, bounds them for the whole cell, and skips the
// cell if it cannot contain the maximum. The values of a voxel are found with the octree over B.
// Unit of the budget: voxels of A whose value is computed; g and G are computed one after the other, each
// with the whole budget.
VoxelDistances distances_by_search(const Voxels& a, const Voxels& b, VoxelWork& work);

}  // namespace hausbench
