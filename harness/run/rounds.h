// Combines the outcomes of a case from several rounds, each in a fresh process, into one. Also derives outcomes for
// coarser tolerances from the outcome with the finest tolerance.
#pragma once

#include "harness/record/row.h"

#include <map>

namespace hausbench {

// Combines the outcomes of a case, keyed by the number of their round; there must be a round 0. Joins the lists of
// first answers, repeats and preparations of all rounds.
//
// If a later round ended normally with another status or other bounds than round 0, the solver is not deterministic,
// and the row is `failed`. If a later round ran out of time or memory or crashed, the row gets the status of that
// round, but keeps the bounds of round 0, which still hold.
Outcome gather_rounds(const std::map<int, const Outcome*>& rounds);

// Return the outcome of a case with a coarser tolerance, given the outcome `fine` with the finest tolerance. `gap` is
// the largest upper - lower that the coarser tolerance allows.
// - read_off_answer(), for solvers that ignore the tolerance, keeps the bounds. The status becomes `ok` if they meet
//   the coarser tolerance.
// - read_off_trace() takes the bounds from the first sample of the trace whose gap is at most `gap`. Without such a
//   sample, or if the witness of `fine` does not prove the sample's lower bound, it keeps the bounds and the status.
// If `fine` is `failed` because the solver is not deterministic, the result is `failed`, too.
Outcome read_off_answer(const Outcome& fine, double gap);
Outcome read_off_trace(const Outcome& fine, double gap);

}  // namespace hausbench
