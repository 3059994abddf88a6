// Functions shared by the exact solvers for point sets.
//
// These solvers compare squared distances and take a root only at the end. exact_result() turns the largest squared
// distance into an interval that contains the exact Hausdorff distance in spite of rounding (proof in
// kernel/rounding.h).
#pragma once

#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/solver.h"

namespace hausbench {

// Returns |a - b|^2. All solvers for point sets compute it with these operations in this order, so their answers have
// the same bits.
inline double squared_distance(const double* a, const double* b) {
    const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return (x * x + y * y) + z * z;
}

// The point of A that is farthest from B among the points examined so far, and the point of B nearest to it.
struct FarthestPoint {
    double squared = -1;             // squared distance; -1 if no point was examined
    Index source = -1, target = -1;  // rows of A and B
};

// Returns whether some |coordinate| exceeds largest_safe_coordinate, so that its square might overflow. A solver then
// returns Result{}, which means status `stalled` and bounds [0, infinity].
inline bool out_of_range(const Points& a, const Points& b) {
    return !(magnitude(a) <= largest_safe_coordinate && magnitude(b) <= largest_safe_coordinate);
}

// Returns the result of a search: bounds, witness and status.
//
// `rest` is an upper bound on the squared distances of the points of A that were not examined, or -1 if all were.
// `stopped` is the reason why the search ended, or `converged` if it ran to its end. If `tiny`, some nonzero
// |coordinate| is below smallest_safe_coordinate, and the bounds are widened for underflow.
//
// If the bounds answer the query, the status says so, whatever the reason to stop. If they do not, although the search
// ran to its end, the query asks for more than doubles can give (`precision_floor`).
inline Result exact_result(const Query& query, const Points& a, const Points& b, const FarthestPoint& farthest,
                           const Counters& counters, bool tiny, double rest, Status stopped) {
    Result result;
    result.counters = counters;
    result.bounds.lower = distance_at_least(std::max(farthest.squared, 0.0),
                                            WATCHED("exact point solvers: underflow in the lower bound", tiny));
    result.bounds.upper = distance_at_most(std::max({farthest.squared, rest, 0.0}),
                                           WATCHED("exact point solvers: underflow in the upper bound", tiny));
    if (farthest.source >= 0) {
        result.witness = {a.row(farthest.source), b.row(farthest.target), farthest.source, farthest.target};
    }
    result.status = query.answer(result.bounds.lower, result.bounds.upper)
                        .value_or(stopped == Status::converged ? Status::precision_floor : stopped);
    return result;
}

// Like exact_result() above, but determines `tiny` itself: looks for nonzero coordinates below smallest_safe_coordinate
// in both sets. O(|A| + |B|).
inline Result exact_result(const Query& query, const Points& a, const Points& b, const FarthestPoint& farthest,
                           const Counters& counters, double rest = -1, Status stopped = Status::converged) {
    const bool tiny = std::min(smallest_nonzero(a), smallest_nonzero(b)) < smallest_safe_coordinate;
    return exact_result(query, a, b, farthest, counters, tiny, rest, stopped);
}

// The part of record() that runs only if tracing is on or a watcher is to be shown the bounds. Not inlined, so that the
// loops that call record() stay small.
[[gnu::noinline, gnu::cold]] inline void record_sample(Trace& trace, double squared_lower, double squared_upper) {
    trace.record(distance_at_least(std::max(squared_lower, 0.0), true),
                 distance_at_most(std::max({squared_lower, squared_upper, 0.0}), true));
}

// Adds a sample with the bounds known so far to the trace, if tracing is on, and shows them to its watcher if that is
// due. The arguments are squared distances; omit an unknown upper bound. Always widens the bounds for underflow, because
// checking whether underflow is possible would take O(n) time.
inline void record(Trace& trace, double squared_lower, double squared_upper = std::numeric_limits<double>::infinity()) {
    if (trace.wants()) [[unlikely]]
        record_sample(trace, squared_lower, squared_upper);
}

// Returns an upper bound on the squared distances from some points of A to B: the largest squared distance from any of
// them to the first point of B. The points are a.row(order[i]) for all i >= first, or a.row(i) if `order` is null.
// Returns -1 if there are none. O(|A|).
inline double squared_distances_at_most(const Points& a, const Points& b, const Index* order, Index first) {
    double most = -1;
    for (Index i = first; i < a.rows(); ++i) {
        most = std::max(most, squared_distance(a.row(order ? order[i] : i).data(), b.data()));
    }
    return most;
}

}  // namespace hausbench
