#include "harness/commands/compare_results.h"

#include "algorithms/error.h"
#include "algorithms/printable.h"
#include "harness/record/row_times.h"
#include "harness/record/statistics.h"

#include <fmt/format.h>

#include <map>
#include <vector>

namespace hausbench {

std::string compare_results(const ResultFile& base, const ResultFile& candidate) {
    std::map<std::string, const Row*> by_key;
    for (const Row& row : base.rows) by_key[row.asked.identity + row.asked.scene] = &row;
    std::string differing, table;
    std::size_t matched = 0, untimed = 0;
    std::map<std::string, std::size_t> apart;  // why their times do not compare
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
        // The builds may differ: they are what is compared.
        if (const std::string why = reason_apart(origin_of(a, ""), origin_of(b, "")); !why.empty()) {
            ++apart[why];
            continue;
        }
        if (b.from_trace) continue;  // its times are those of the row it was read off
        const bool cpu = cpu_clock(b);
        const bool again = !a.repeats.empty() && !b.repeats.empty();  // else the first answers are what was timed
        const Estimate ratio = again ? ratio_by_round(again_by_round(a, cpu), again_by_round(b, cpu))
                                     : ratio_by_round(first_by_round(a, cpu), first_by_round(b, cpu));
        if (ratio.n == 0) {
            ++untimed;
            continue;
        }
        all.push_back(ratio.value);
        table += fmt::format("  {:<60} {:>8.4g} [{:.4g}, {:.4g}]  n = {:<3} {:>5.1f} %  {:<4}  {}\n",
                             name_of(row.asked), ratio.value, ratio.low, ratio.high, ratio.n, 100 * ratio.confidence,
                             cpu ? "CPU" : "wall", verdict_of(ratio));
    }
    if (matched == 0)
        throw InputError("the two results have no case in common: compare results of the same experiment and profile");
    std::string text;
    for (const char* name : {"build", "machine"}) {
        const std::string a = printable(base.texts.at(name)), b = printable(candidate.texts.at(name));
        if (a != b) text += fmt::format("{}s differ: {:.12} and {:.12}\n", name, a, b);
    }
    text += fmt::format("{} cases in both, {} only in the first, {} only in the second\n", matched,
                        base.rows.size() - matched, candidate.rows.size() - matched);
    text += differing.empty() ? "answers: all the same\n" : "ANSWERS THAT DIFFER\n" + differing;
    text +=
        fmt::format(
            "time of the second / time of the first, median over rounds [interval], CPU or wall time; a verdict takes "
            "six rounds ({} cases without times)\n",
            untimed) +
        table;
    for (const auto& [why, cases] : apart)
        text += fmt::format("  {} cases without a ratio: their times are {}\n", cases, why);
    if (!all.empty()) text += fmt::format("  geometric mean over {} cases: {:.4g}\n", all.size(), geometric_mean(all));
    return text;
}

}  // namespace hausbench
