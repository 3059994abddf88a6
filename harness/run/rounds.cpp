#include "harness/run/rounds.h"

#include "harness/run/timing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace hausbench {

namespace {

// Returns whether the solver ended normally, so that it must end in the same way again on the same input. A time limit
// or a crash may stop it anywhere.
bool ended_by_itself(const Outcome& o) {
    return o.status == RowStatus::ok || o.status == RowStatus::floor || o.status == RowStatus::budget ||
           (o.status == RowStatus::failed && o.solver_status == to_string(Status::stalled));
}

// Returns whether the case failed although the solver gave bounds: either two runs gave different bounds, or the
// process failed later, while repeats were timed.
bool contradicts_itself(const Outcome& o) {
    return o.status == RowStatus::failed && !o.solver_status.empty() && !ended_by_itself(o);
}

// Updates the status of `outcome`, which combines the rounds so far, by the outcome of the next round.
void add_round(Outcome& outcome, const Outcome& first, int round, const Outcome& next) {
    if (contradicts_itself(outcome)) return;
    if (!ended_by_itself(next)) {
        if (!ended_by_itself(outcome)) return;
        outcome.status = next.status;
        outcome.reason = fmt::format("in round {}: {}", round, next.reason);
        outcome.solver_status = next.solver_status;
    } else if (ended_by_itself(first) && (next.status != first.status || next.bounds.lower != first.bounds.lower ||
                                          next.bounds.upper != first.bounds.upper)) {
        outcome.status = RowStatus::failed;
        outcome.reason = fmt::format("round {} gave {} [{}, {}]: the solver is not deterministic", round,
                                     to_string(next.status), next.bounds.lower, next.bounds.upper);
        outcome.solver_status = first.solver_status;
    }
}

double median(std::vector<double> values) {
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    return (values[(n - 1) / 2] + values[n / 2]) / 2;
}

}  // namespace

Outcome gather_rounds(const std::map<int, const Outcome*>& rounds) {
    const Outcome& first = *rounds.at(0);
    Outcome outcome = first;
    std::vector<double> prepare_seconds;
    for (const auto& [round, next] : rounds) {
        if (std::isfinite(next->prepare_seconds)) prepare_seconds.push_back(next->prepare_seconds);
        if (next->clock == "wall") outcome.clock = "wall";
        outcome.side_by_side = outcome.side_by_side || next->side_by_side;
        if (round == 0) continue;
        outcome.answers.insert(outcome.answers.end(), next->answers.begin(), next->answers.end());
        outcome.repeats.insert(outcome.repeats.end(), next->repeats.begin(), next->repeats.end());
        outcome.preparation.insert(outcome.preparation.end(), next->preparation.begin(), next->preparation.end());
        add_round(outcome, first, round, *next);
    }
    outcome.prepare_seconds = median(std::move(prepare_seconds));
    for (const Repeat& r : outcome.repeats) {
        if (several_at_once(r.wall_seconds, r.cpu_seconds)) outcome.clock = "wall";
    }
    return outcome;
}

Outcome read_off_answer(const Outcome& fine, double gap) {
    Outcome outcome = fine;
    outcome.from_trace = true;
    if (is_timed(outcome.status) && outcome.bounds.gap() <= gap) {
        outcome.status = RowStatus::ok;
        outcome.reason.clear();
        outcome.solver_status = to_string(Status::converged);
    }
    return outcome;
}

Outcome read_off_trace(const Outcome& fine, double gap) {
    Outcome outcome = fine;
    outcome.from_trace = true;
    outcome.answers.clear();
    outcome.repeats.clear();
    outcome.trace.clear();
    // The seconds of the solver's stages belong to the finer run only.
    std::erase_if(outcome.extras, [](const auto& extra) { return extra.first.starts_with(stage_prefix); });
    if (contradicts_itself(fine)) return outcome;
    for (const TraceSample& sample : fine.trace) {
        if (!(sample.upper - sample.lower <= gap)) continue;
        // The trace belongs to a second solve. If the clock stopped the first one earlier, its witness proves only its
        // own lower bound.
        if (sample.lower > fine.bounds.lower) break;
        outcome.bounds = {sample.lower, sample.upper};
        outcome.solve_seconds = sample.seconds;
        outcome.status = RowStatus::ok;
        outcome.reason.clear();
        outcome.solver_status = to_string(Status::converged);
        break;
    }
    return outcome;
}

}  // namespace hausbench
