// Combines the rounds of a case into the one outcome of its row, and reads rows of coarser tolerances off the trace
// of a fine one.
#pragma once

#include "harness/record/row.h"

#include <map>

namespace hausbench {

// Combines outcomes by the number of their round; round 0 must be present. Repeats and preparations of all rounds go
// into one list each.
//
// The row is `failed` if two rounds that ended by themselves have different bounds: the solver is not deterministic.
// If a later round did not end by itself (it ran out of time or memory, or crashed), the row gets the status of that
// round and the bounds of round 0, which still hold.
Outcome gather_rounds(const std::map<int, const Outcome*>& rounds);

// Return the outcome of a case with a coarser tolerance. read_off_answer(), for a solver that ignores the tolerance,
// returns `fine` itself; read_off_trace() takes the first sample of its trace whose gap is at most `gap`. A run that
// was not deterministic has no answer for any tolerance: it stays `failed`.
Outcome read_off_answer(const Outcome& fine, double gap);
Outcome read_off_trace(const Outcome& fine, double gap);

}  // namespace hausbench
