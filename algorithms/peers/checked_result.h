// Derives certified bounds from the nearest-point searches of a library that gives no guarantee.
#pragma once

#include "algorithms/kernel/watched.h"
#include "algorithms/points/exact.h"

namespace hausbench {

// Returns a certified result. `farthest` is the largest distance that the searches of the library found, with its two
// points. `rest` and `stopped` are as for exact_result().
//
// This distance is an upper bound on h even if a search missed the nearest point, because each search returned some
// point of B. The lower bound is the true distance to B of the point of A in `farthest`, which is compared with all of
// B. O(|B|).
inline Result checked_result(const Query& query, const Points& a, const Points& b, FarthestPoint farthest,
                             Counters counters, double rest = -1, Status stopped = Status::converged) {
    if (farthest.source >= 0) {
        const double claimed = farthest.squared;
        farthest.squared = std::numeric_limits<double>::infinity();
        for (Index j = 0; j < b.rows(); ++j) {
            const double squared = squared_distance(a.row(farthest.source).data(), b.row(j).data());
            if (WATCHED_ELSE("peers for point sets: the lower bound, compared with all of B again",
                             squared < farthest.squared, squared == claimed)) {
                farthest.squared = squared;
                farthest.target = j;
            }
        }
        counters.point_distances += static_cast<std::uint64_t>(b.rows());
        if (WATCHED("peers for point sets: the largest distance that searches found, in the upper bound", true))
            rest = std::max(rest, claimed);
    }
    return exact_result(query, a, b, farthest, counters, rest, stopped);
}

}  // namespace hausbench
