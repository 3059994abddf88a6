#include "commands/compare_results.h"

#include "error.h"
#include "record/statistics.h"

#include <fmt/format.h>

#include <map>
#include <vector>

namespace hausbench {

std::string compare_results(const ResultFile& base, const ResultFile& candidate) {
    std::map<std::string, const Row*> by_key;
    for (const Row& row : base.rows) by_key[row.asked.identity + row.asked.scene] = &row;
    std::string differing, table;
    std::size_t matched = 0, untimed = 0, beside = 0;
    std::vector<double> all;
    for (const Row& row : candidate.rows) {
        const auto at = by_key.find(row.asked.identity + row.asked.scene);
        if (at == by_key.end()) continue;
        ++matched;
        const Outcome &a = at->second->outcome, &b = row.outcome;
        if (!same_answer(a, b)) {
            differing += fmt::format("  {}: {} [{:.17g}, {:.17g}] -> {} [{:.17g}, {:.17g}]\n", name_of(row.asked),
                                     to_string(a.status), a.bounds.lower, a.bounds.upper, to_string(b.status),
                                     b.bounds.lower, b.bounds.upper);
        }
        if (a.side_by_side || b.side_by_side) {
            ++beside;
            continue;
        }
        if (b.from_trace) continue;                             // its times are those of the row it was read off
        const bool cpu = a.clock == "cpu" && b.clock == "cpu";  // one thread in both, see timing.h
        const auto times = [cpu](const auto& timed) {
            std::vector<double> seconds;
            for (const auto& t : timed) seconds.push_back(cpu ? t.cpu_seconds : t.wall_seconds);
            return seconds;
        };
        const bool again = !a.repeats.empty() && !b.repeats.empty();  // else the first answers are what was timed
        const std::vector<double> before = again ? times(a.repeats) : times(a.answers),
                                  after = again ? times(b.repeats) : times(b.answers);
        if (before.empty() || after.empty()) {
            ++untimed;
            continue;
        }
        const Estimate ratio = paired_ratio(before, after);
        all.push_back(ratio.value);
        table += fmt::format("  {:<60} {:>8.4g} [{:.4g}, {:.4g}]  n = {:<3} {:>5.1f} %  {:<4}  {}\n",
                             name_of(row.asked), ratio.value, ratio.low, ratio.high, ratio.n, 100 * ratio.confidence,
                             cpu ? "CPU" : "wall", verdict_of(ratio));
    }
    if (matched == 0)
        throw InputError("the two results have no case in common: compare results of the same experiment and profile");
    std::string text;
    for (const char* name : {"build", "machine"}) {
        const std::string &a = base.texts.at(name), &b = candidate.texts.at(name);
        if (a != b) text += fmt::format("{}s differ: {:.12} and {:.12}\n", name, a, b);
    }
    text += fmt::format("{} cases in both, {} only in the first, {} only in the second\n", matched,
                        base.rows.size() - matched, candidate.rows.size() - matched);
    text += differing.empty() ? "answers: all the same\n" : "ANSWERS THAT DIFFER\n" + differing;
    text += fmt::format(
                "time of the second / time of the first, median of paired repeats [interval], CPU or wall time ({} "
                "cases without times)\n",
                untimed) +
            table;
    if (beside > 0)
        text +=
            fmt::format("  {} cases were run beside others (--jobs, or a cluster): their times are left out\n", beside);
    if (!all.empty()) text += fmt::format("  geometric mean over {} cases: {:.4g}\n", all.size(), geometric_mean(all));
    return text;
}

}  // namespace hausbench
