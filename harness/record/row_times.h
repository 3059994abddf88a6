// The times of a row by round. Each round is a separate process. Statistics use one value per round, because repeats
// inside one process are not independent.
#pragma once

#include "harness/record/estimates.h"
#include "harness/record/row.h"

#include <map>
#include <string>

namespace hausbench {

using ByRound = std::map<int, double>;  // seconds

inline bool cpu_clock(const Outcome& outcome) { return outcome.clock == "cpu"; }

// Each of these functions returns one time per round, or an empty map if nothing was timed. `cpu` selects CPU time
// instead of wall time.
ByRound first_by_round(const Outcome& outcome, bool cpu);  // of the first answer
ByRound again_by_round(const Outcome& outcome, bool cpu);  // of solving again: the median of the timed repeats
ByRound total_by_round(const Outcome& outcome, bool cpu);  // of preparing (always wall time) and the first answer

// The properties of a row that decide whether its times are comparable with the times of another row.
struct Origin {
    bool beside;  // --jobs or a cluster may have run other cases at the same time
    std::string machine, program, clock;
};

// Returns the origin of an outcome's times. `program` is the build of the program without plug-ins (class Programs in
// result/provenance.h).
Origin origin_of(const Outcome& outcome, const std::string& program);

// Returns why the times of two rows are not comparable, such as "of different machines". Returns an empty string if
// they are comparable. analysis/shared/comparable.py has the same rule.
std::string reason_apart(const Origin& a, const Origin& b);

// Returns the time to solve, by the clock of the row: the median over rounds of again_by_round() or, if nothing was
// repeated, of first_by_round(). If only one round has repeats, returns their median, with their extremes in place of a
// confidence interval. If nothing was timed, n is 0.
Estimate time_of(const Outcome& outcome);

// Returns the median ratio candidate / base over the rounds that both have. If there are none, n is 0.
Estimate ratio_by_round(const ByRound& base, const ByRound& candidate);

}  // namespace hausbench
