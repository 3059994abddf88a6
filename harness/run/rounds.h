// From what the rounds of a case brought to the one outcome of its row, and from the trace of a fine tolerance to the rows of
// coarser ones.
#pragma once

#include "harness/record/row.h"

#include <map>

namespace hausbench {

// By number of the round; the first is number 0 and there. Repeats and preparations of all of them stand in one list.
//
// The row is `failed` where two rounds that came to their own end have other bounds: the solver is not deterministic. Where a
// later round came to no such end (it ran out of time or memory, or crashed), the row gets its status and the bounds of
// round 0, which hold all the same.
Outcome gather_rounds(const std::map<int, const Outcome*>& rounds);

// The outcome of a case with a coarser tolerance: `fine` itself where the solver ignores the tolerance, else the first sample of its
// trace whose gap is at most `gap`. A run that was not deterministic holds no answer for any tolerance: it stays `failed`.
Outcome read_off_answer(const Outcome& fine, double gap);
Outcome read_off_trace(const Outcome& fine, double gap);

}  // namespace hausbench
