// Distances between the voxels of two surfaces. The distance of two voxels is an interval [g, G]: the least and the
// largest distance between a point of one and a point of the other. The result is [max over A of min over B of g, max
// over A of min over B of G].
//
// If the budget or the time runs out, VoxelWork::stopped is set. The results are then too small, because they are
// maxima over only a part of A.
#pragma once

#include "algorithms/kernel/deadline.h"
#include "algorithms/solver.h"
#include "algorithms/surfaces/interval_subdivision/voxels.h"

#include <optional>

namespace hausbench::interval_subdivision {

struct VoxelWork {
    const Query& query;
    const Deadline& deadline;
    Counters counters;
    std::optional<Status> stopped;

    // Returns whether the budget or the time has run out, and sets `stopped` to the reason. `done` is the work done, in
    // the unit of the budget.
    bool stop_after(std::uint64_t done) {
        if (done >= query.budget) stopped = Status::budget;
        if (deadline.passed()) stopped = Status::time_limit;
        return stopped.has_value();
    }
};

struct VoxelDistances {
    double least = 0, largest = 0;  // squares of the least and the largest distance
};

// Returns the square of the largest distance between a point of one box and a point of the other.
double largest_squared_distance(const Box& a, const Box& b);

// Computes the result by comparing all pairs of voxels. The unit of the budget is one voxel of A.
VoxelDistances distances_of_all(const Voxels& a, const Voxels& b, VoxelWork& work);

// Computes the same bits as distances_of_all() from far fewer pairs. All voxels of A are translates of each other. So
// from one voxel of A to another, min over B of g grows by at most the length of the translation, and so does min over
// B of G. The search computes both for one voxel of a cell of the octree over A, bounds them for the whole cell, and
// skips the cell if it cannot contain the maximum. It finds the values of a voxel with the octree over B. The unit of
// the budget is one voxel of A whose value is computed; g and G are computed one after the other, each with the whole
// budget.
VoxelDistances distances_by_search(const Voxels& a, const Voxels& b, VoxelWork& work);

}  // namespace hausbench::interval_subdivision
