// The times of a row by round. Each round is a separate process. The round is the unit of every statistic, because
// repeats inside one process are not independent.
#pragma once

#include "harness/record/row.h"
#include "harness/record/statistics.h"

#include <map>
#include <string>

namespace hausbench {

using ByRound = std::map<int, double>;  // seconds

inline bool cpu_clock(const Outcome& outcome) { return outcome.clock == "cpu"; }

// Return for each round the time of the first answer; the time of solving again, which is the median of the timed
// repeats of the round; and the time of preparing plus the first answer. Empty if nothing was timed. `cpu` selects CPU
// time of the process instead of wall time; the time of preparing is always wall time.
ByRound first_by_round(const Outcome& outcome, bool cpu);
ByRound again_by_round(const Outcome& outcome, bool cpu);
ByRound total_by_round(const Outcome& outcome, bool cpu);

// The properties of a row that decide whether its times are comparable with another row's.
struct Origin {
    bool beside;  // --jobs or a cluster may have run other cases at the same time
    std::string machine, program, clock;
};

// `program` is the build of the program without its plug-ins (class Programs in result/provenance.h).
Origin origin_of(const Outcome& outcome, const std::string& program);

// Returns why the times of two rows are not comparable, such as "of different machines"; empty if
// they are. analysis/shared/comparable.py has the same rule.
std::string reason_apart(const Origin& a, const Origin& b);

// Returns the time to solve, by the clock of the row: the median over rounds of again_by_round(), with its interval, or
// of the first answers if nothing was repeated. If the repeats are all of a single round, their median, with the
// extremes in place of an interval. n = 0 if nothing was timed.
Estimate time_of(const Outcome& outcome);

// Returns the median ratio `candidate` / `base` over the rounds that both have; n = 0 if there are none.
Estimate ratio_by_round(const ByRound& base, const ByRound& candidate);

}  // namespace hausbench
