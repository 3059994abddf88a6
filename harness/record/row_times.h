// The times of a row by round. The round is the unit of every statistic: it is a process of its own, and repeats inside one
// process are not independent.
#pragma once

#include "record/row.h"
#include "record/statistics.h"

#include <map>

namespace hausbench {

using ByRound = std::map<int, double>;  // seconds

inline bool cpu_clock(const Outcome& outcome) { return outcome.clock == "cpu"; }

// Of solving again: the median of a round's timed repeats. Of preparing and the first answer together. Empty where nothing was
// timed. `cpu`: by the CPU time of the process, else by wall time; preparing always by wall time.
ByRound again_by_round(const Outcome& outcome, bool cpu);
ByRound total_by_round(const Outcome& outcome, bool cpu);

// Time to solve, by the clock of the row: over rounds of again_by_round(), or of the first answers where nothing was repeated.
// Of a single round the median and the extremes of its repeats. n = 0 if nothing was timed.
Estimate time_of(const Outcome& outcome);

// Of what stands in both, `candidate` / `base` round by round; n = 0 if nothing does.
Estimate ratio_by_round(const ByRound& base, const ByRound& candidate);

}  // namespace hausbench
