// Combines the outcomes of a case in several rounds (fresh processes) into the one outcome of its row. Also reads the
// outcomes of coarser tolerances off the outcome of the finest one.
#pragma once

#include "harness/record/row.h"

#include <map>

namespace hausbench {

// Combines the outcomes of a case, given with the numbers of their rounds; round 0 must be present. First answers,
// repeats and preparations of all rounds go into one list each.
//
// If a later round ended by itself with another status or other bounds than round 0, the solver is not deterministic,
// and the row is `failed`. If a later round did not end by itself (it ran out of time or memory, or crashed), the row
// gets the status of that round and keeps the bounds of round 0, which still hold.
Outcome gather_rounds(const std::map<int, const Outcome*>& rounds);

// Return the outcome of a case with a coarser tolerance. `gap` is the largest upper - lower that this tolerance allows,
// `fine` the outcome with the finest tolerance.
// - read_off_answer() is for solvers that ignore the tolerance. It keeps the bounds; the status becomes `ok` if they
//   meet the coarser tolerance.
// - read_off_trace() takes the bounds from the first sample of the trace with a gap of at most `gap`. Without such a
//   sample, it keeps bounds and status.
// If `fine` is `failed` because the solver is not deterministic, so is the result.
Outcome read_off_answer(const Outcome& fine, double gap);
Outcome read_off_trace(const Outcome& fine, double gap);

}  // namespace hausbench
