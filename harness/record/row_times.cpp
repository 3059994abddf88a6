#include "harness/record/row_times.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hausbench {

namespace {

template <class Timed> double seconds_of(const Timed& timed, bool cpu) {
    return cpu ? timed.cpu_seconds : timed.wall_seconds;
}

std::vector<double> values(const ByRound& rounds) {
    std::vector<double> seconds;
    for (const auto& [round, s] : rounds) seconds.push_back(s);
    return seconds;
}

}  // namespace

ByRound first_by_round(const Outcome& outcome, bool cpu) {
    ByRound rounds;
    for (const FirstAnswer& answer : outcome.answers) {
        if (const double s = seconds_of(answer, cpu); std::isfinite(s)) rounds[answer.round] = s;
    }
    return rounds;
}

ByRound again_by_round(const Outcome& outcome, bool cpu) {
    std::map<int, std::vector<double>> repeats;
    for (const Repeat& repeat : outcome.repeats) {
        if (const double s = seconds_of(repeat, cpu); std::isfinite(s)) repeats[repeat.round].push_back(s);
    }
    ByRound rounds;
    for (auto& [round, seconds] : repeats) rounds[round] = median(std::move(seconds)).value;
    return rounds;
}

ByRound total_by_round(const Outcome& outcome, bool cpu) {
    ByRound rounds = first_by_round(outcome, cpu), prepared;
    for (const Preparation& part : outcome.preparation)
        prepared[part.round] += std::isfinite(part.seconds) ? part.seconds : 0;
    const double usual = std::isfinite(outcome.prepare_seconds) ? outcome.prepare_seconds : 0;
    for (auto& [round, seconds] : rounds) {
        const auto at = prepared.find(round);
        seconds += at == prepared.end() ? usual : at->second;
    }
    return rounds;
}

Origin origin_of(const Outcome& outcome, const std::string& program) {
    return {outcome.side_by_side, outcome.machine, program, outcome.clock};
}

std::string reason_apart(const Origin& a, const Origin& b) {
    if (a.beside || b.beside) return "run beside others";
    if (a.machine != b.machine) return "of different machines";
    if (a.program != b.program) return "of different builds";
    if (!a.clock.empty() && !b.clock.empty() && a.clock != b.clock) return "by different clocks";
    return "";
}

Estimate time_of(const Outcome& outcome) {
    const bool cpu = cpu_clock(outcome);
    ByRound rounds = again_by_round(outcome, cpu);
    if (rounds.size() == 1) {
        std::vector<double> repeats;
        for (const Repeat& repeat : outcome.repeats) {
            if (const double s = seconds_of(repeat, cpu); std::isfinite(s)) repeats.push_back(s);
        }
        Estimate estimate = median(repeats);
        estimate.low = *std::min_element(repeats.begin(), repeats.end());
        estimate.high = *std::max_element(repeats.begin(), repeats.end());
        estimate.confidence = 0;
        return estimate;
    }
    if (rounds.empty()) rounds = first_by_round(outcome, cpu);
    if (!rounds.empty()) return median(values(rounds));
    Estimate read_off;  // from a trace, or from a file of an older program
    if (std::isfinite(outcome.solve_seconds)) {
        read_off.value = read_off.low = read_off.high = outcome.solve_seconds;
        read_off.n = 1;
    }
    return read_off;
}

Estimate ratio_by_round(const ByRound& base, const ByRound& candidate) {
    std::vector<double> before, after;
    for (const auto& [round, seconds] : base) {
        const auto at = candidate.find(round);
        if (at == candidate.end() || !(seconds > 0) || !(at->second > 0)) continue;
        before.push_back(seconds);
        after.push_back(at->second);
    }
    return before.empty() ? Estimate{} : paired_ratio(before, after);
}

}  // namespace hausbench
