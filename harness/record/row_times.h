// The times of a row by round. The round is the unit of every statistic: it is a process of its own, and repeats inside one
// process are not independent.
#pragma once

#include "harness/record/row.h"
#include "harness/record/statistics.h"

#include <map>
#include <string>

namespace hausbench {

using ByRound = std::map<int, double>;  // seconds

inline bool cpu_clock(const Outcome& outcome) { return outcome.clock == "cpu"; }

// Times of solving again (the median of a round's timed repeats), of the first answer, and of preparing and the first answer together.
// Empty if nothing was timed. `cpu`: by the CPU time of the process, else by wall time; preparing always by wall time.
ByRound first_by_round(const Outcome& outcome, bool cpu);
ByRound again_by_round(const Outcome& outcome, bool cpu);
ByRound total_by_round(const Outcome& outcome, bool cpu);

// Everything that decides whether the times of a row are comparable with another row's.
struct Origin {
    bool beside;  // --jobs or a cluster may have run other cases at the same time
    std::string machine, program, clock;
};

// `program`: the build of the program, without its plug-ins (Programs in result/provenance.h).
Origin origin_of(const Outcome& outcome, const std::string& program);

// Returns why the times of two rows do not compare, such as "of different machines"; empty if they do. The same rule as in
// analysis/shared/comparable.py.
std::string reason_apart(const Origin& a, const Origin& b);

// Returns the time to solve, by the clock of the row: over rounds of again_by_round(), or of the first answers if
// nothing was repeated. For a single round it is the median and the extremes of its repeats. n = 0 if nothing was
// timed.
Estimate time_of(const Outcome& outcome);

// Returns `candidate` / `base` round by round, over the rounds that both have; n = 0 if they share none.
Estimate ratio_by_round(const ByRound& base, const ByRound& candidate);

}  // namespace hausbench
