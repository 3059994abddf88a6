// Certified statistics of the distance from A to B.
#pragma once

#include "algorithms/meshes/distribution/statistics.h"

#include <vector>

namespace hausbench {

struct DistributionQuery {
    std::vector<Statistic> statistics;
    Tolerance tolerance;            // of each statistic but shares
    double share_tolerance = 1e-3;  // of shares: a number without a unit
    double time_limit = std::numeric_limits<double>::infinity();
    std::size_t most_pieces = 20'000'000;  // 300 bytes each
    int threads = 1;
};

struct DistributionResult {
    Status status = Status::stalled;
    std::vector<Bounds> bounds;  // of each statistic
    std::size_t pieces = 0;
    Counters counters;
};

// Computes the statistics of the distance to the mesh of `target` over the triangles with corners in `points`. Cuts the
// pieces with the largest gaps until all statistics are within the tolerance. `magnitude` is M of kernel/rounding.h.
DistributionResult distribution_of(const Triangles& triangles, const Points& points, const TriangleBlocks& target,
                                   double magnitude, WeighBy weigh, const DistributionQuery& query);

}  // namespace hausbench
