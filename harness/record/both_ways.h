// H(A,B) from answers for h(A,B) and h(B,A), each to the full tolerance. (Symmetric in algorithms/session/ answers H(A,B)
// alone: it may stop the second direction once it is known to be below the first.)
#pragma once

#include "algorithms/solver.h"

namespace hausbench {

// Takes the answer for h(B,A), for which a solver has the shapes swapped. Swaps the ends of the witness back, so that
// its source point is on A again, and marks the direction.
Result turned(Result result);

// Combines both directions into H(A,B). If both gaps are within the tolerance, so is the gap of H. The upper bound of H
// is the larger of the two upper bounds. The lower bound of H is at least the lower bound of the direction that has
// this upper bound, so the gap of H is at most the gap of that direction.
Result larger_of(const Query& query, const Result& forward, const Result& backward);

}  // namespace hausbench
