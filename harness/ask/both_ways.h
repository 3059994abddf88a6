// H(A,B) from answers for h(A,B) and h(B,A), each to the full tolerance. (Symmetric in algorithms/session/ answers H(A,B)
// alone: it may stop the second direction once it is known to be below the first.)
#pragma once

#include "algorithms/solver.h"

#include <functional>
#include <optional>

namespace hausbench {

// Takes the answer for h(B,A), for which a solver has the shapes swapped. Swaps the ends of the witness back, so that
// its source point is on A again, and marks the direction.
Result turned(Result result);

// Combines both directions into H(A,B). If both gaps are within the tolerance, so is the gap of H. The upper bound of H
// is the larger of the two upper bounds. The lower bound of H is at least the lower bound of the direction that has
// this upper bound, so the gap of H is at most the gap of that direction.
Result larger_of(const Query& query, const Result& forward, const Result& backward);

// The answer for H(A,B), and the answers of the two directions as far as they were asked. In all of them the source
// point of the witness is on A.
struct BothWays {
    Result whole;
    std::optional<Result> forward, backward;
};

// Answers h(A,B), or h(B,A) with the shapes swapped if `backward`. Calls `closer` with bounds on the way.
using AskOneWay = std::function<Result(bool backward, const std::function<void(const Result&)>& closer)>;

// Answers H(A,B) by asking for both directions, each to the full tolerance. Asks for h(A,B) alone if that is above the
// cutoff of the query; then H(A,B) has no upper bound. Calls `closer` with the answers on the way.
BothWays ask_both_ways(const Query& query, const AskOneWay& ask, const std::function<void(const BothWays&)>& closer);

}  // namespace hausbench
