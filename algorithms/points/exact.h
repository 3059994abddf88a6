// Turns squared distances into certified results (rounding.h), for the exact solvers of point sets.
#pragma once

#include "algorithms/kernel/rounding.h"
#include "algorithms/solver.h"

namespace hausbench {

inline double squared_distance(const double* a, const double* b) {
    const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return (x * x + y * y) + z * z;
}

// The point of A farthest from B so far, and its nearest point of B.
struct FarthestPoint {
    double squared = -1;
    Index source = -1, target = -1;
};

// Returns whether coordinates are beyond the range that rounding.h covers; a solver then returns Result{}: stalled,
// in [0, infinity].
inline bool out_of_range(const Points& a, const Points& b) {
    return !(magnitude(a) <= largest_safe_coordinate && magnitude(b) <= largest_safe_coordinate);
}

// Returns the result of a search. `rest` bounds the squared distances of the points of A that were not examined, -1
// if there are none; `stopped` is the reason for stopping. `tiny`: some nonzero coordinate is smaller than
// smallest_safe_coordinate.
inline Result exact_result(const Query& query, const Points& a, const Points& b, const FarthestPoint& farthest,
                           const Counters& counters, bool tiny, double rest, Status stopped) {
    Result result;
    result.counters = counters;
    result.bounds.lower = distance_at_least(std::max(farthest.squared, 0.0), tiny);
    result.bounds.upper = distance_at_most(std::max({farthest.squared, rest, 0.0}), tiny);
    if (farthest.source >= 0) {
        result.witness = {a.row(farthest.source), b.row(farthest.target), farthest.source, farthest.target};
    }
    result.status = query.answer(result.bounds.lower, result.bounds.upper)
                        .value_or(stopped == Status::converged ? Status::precision_floor : stopped);
    return result;
}

// Does the same for solvers that did not look for tiny coordinates. O(n).
inline Result exact_result(const Query& query, const Points& a, const Points& b, const FarthestPoint& farthest,
                           const Counters& counters, double rest = -1, Status stopped = Status::converged) {
    const bool tiny = std::min(smallest_nonzero(a), smallest_nonzero(b)) < smallest_safe_coordinate;
    return exact_result(query, a, b, farthest, counters, tiny, rest, stopped);
}

// A separate function, so that the loops that call record() stay small.
[[gnu::noinline, gnu::cold]] inline void record_sample(Trace& trace, double squared_lower, double squared_upper) {
    trace.record(distance_at_least(std::max(squared_lower, 0.0), true),
                 distance_at_most(std::max({squared_lower, squared_upper, 0.0}), true));
}

// Adds a sample to the trace from bounds of the squared distance, rounded as if coordinates were tiny. Infinity means
// that there is no upper bound yet.
inline void record(Trace& trace, double squared_lower, double squared_upper = std::numeric_limits<double>::infinity()) {
    if (trace.on()) [[unlikely]]
        record_sample(trace, squared_lower, squared_upper);
}

// Returns an upper bound for the points order[first..] of A (first.. if `order` is null): their largest squared
// distance to the first point of B; -1 if there are none. O(n).
inline double squared_distances_at_most(const Points& a, const Points& b, const Index* order, Index first) {
    double most = -1;
    for (Index i = first; i < a.rows(); ++i) {
        most = std::max(most, squared_distance(a.row(order ? order[i] : i).data(), b.data()));
    }
    return most;
}

}  // namespace hausbench
