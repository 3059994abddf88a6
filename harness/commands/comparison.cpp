#include "harness/commands/comparison.h"

#include "algorithms/error.h"
#include "algorithms/printable.h"
#include "harness/commands/row_choice.h"
#include "harness/record/estimates.h"
#include "harness/record/profiles.h"
#include "harness/record/row_times.h"
#include "harness/result/provenance.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

namespace hausbench {

const ResultPart& compared_part() {
    static const ResultPart part{
        {"identity",        "solver",       "label",       "variant",    "profile",      "scene",     "source",
         "target",          "pose",         "target_pose", "pose_index", "quantity",     "statistic", "weigh",
         "tolerance",       "tolerance_of", "floor",       "cutoff",     "lower",        "upper",     "status",
         "prepare_seconds", "clock",        "from_trace",  "warm",       "side_by_side", "build",     "machine"},
        true,
        true};
    return part;
}

std::set<std::string> unlike_models(const ResultFile& one, const ResultFile& other) {
    std::map<std::string, std::string> hashes;
    for (const ModelRecord& model : one.models) hashes[model.name] = model.sha256;
    std::set<std::string> unlike;
    for (const ModelRecord& model : other.models) {
        const auto at = hashes.find(model.name);
        if (at != hashes.end() && at->second != model.sha256) unlike.insert(model.name);
    }
    return unlike;
}

bool is_of(const Case& spec, const std::set<std::string>& models) {
    return models.contains(spec.source) || models.contains(spec.target);
}

namespace {

// Returns a line that counts the rows of models that are different shapes in the two results, or an empty string.
std::string unlike_text(const ResultFile& base, const ResultFile& candidate) {
    const std::set<std::string> unlike = unlike_models(base, candidate);
    const auto count = [&](const ResultFile& result) {
        return std::count_if(result.rows.begin(), result.rows.end(),
                             [&](const Row& row) { return is_of(row.spec, unlike); });
    };
    const auto first = count(base), second = count(candidate);
    if (first + second == 0) return "";
    return fmt::format(
        "not compared, because the two results have other shapes under these names: {} and {} cases of {}", first,
        second, printable(fmt::format("{}", fmt::join(unlike, ", "))));
}

}  // namespace

std::string compare_results(const ResultFile& base, const ResultFile& candidate) {
    std::map<std::string, const Row*> by_key;
    for (const Row& row : base.rows) by_key[row.spec.identity + row.spec.scene] = &row;
    std::string differing, table;
    std::size_t matched = 0, untimed = 0;
    std::map<std::string, std::size_t> apart;  // reason why times are not comparable -> number of cases
    std::vector<double> all;
    for (const Row& row : candidate.rows) {
        const auto at = by_key.find(row.spec.identity + row.spec.scene);
        if (at == by_key.end()) continue;
        ++matched;
        const Outcome &a = at->second->outcome, &b = row.outcome;
        if (!same_answer(a, b)) {
            differing += fmt::format("  {}: {} [{:.17g}, {:.17g}] -> {} [{:.17g}, {:.17g}]\n", name_of(row.spec),
                                     to_string(a.status), a.bounds.lower, a.bounds.upper, to_string(b.status),
                                     b.bounds.lower, b.bounds.upper);
        }
        // Ignores the builds (""), because the purpose is to compare them.
        if (const std::string why = reason_apart(origin_of(a, ""), origin_of(b, "")); !why.empty()) {
            ++apart[why];
            continue;
        }
        if (b.from_trace) continue;  // its times belong to the row whose trace it was read from
        const bool cpu = cpu_clock(b);
        const bool again = !a.repeats.empty() && !b.repeats.empty();  // otherwise compares the first answers
        const Estimate ratio = again ? ratio_by_round(again_by_round(a, cpu), again_by_round(b, cpu))
                                     : ratio_by_round(first_by_round(a, cpu), first_by_round(b, cpu));
        if (ratio.n == 0) {
            ++untimed;
            continue;
        }
        all.push_back(ratio.value);
        table += fmt::format("  {:<60} {:>8.4g} [{:.4g}, {:.4g}]  n = {:<3} {:>5.1f} %  {:<4}  {}\n", name_of(row.spec),
                             ratio.value, ratio.low, ratio.high, ratio.n, 100 * ratio.confidence, cpu ? "CPU" : "wall",
                             verdict_of(ratio));
    }
    const std::string unlike = unlike_text(base, candidate);
    if (matched == 0)
        throw InputError("the two results have no case in common: " +
                         (unlike.empty() ? "compare results of the same experiment and profile" : unlike));
    std::string text;
    for (const char* name : {"build", "machine"}) {
        const std::string a = printable(base.texts.at(name)), b = printable(candidate.texts.at(name));
        if (a != b) text += fmt::format("{}s differ: {:.12} and {:.12}\n", name, a, b);
    }
    text += fmt::format("{} cases in both, {} only in the first, {} only in the second\n", matched,
                        base.rows.size() - matched, candidate.rows.size() - matched);
    if (!unlike.empty()) text += unlike + "\n";
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

namespace {

// The problem that a row solves, without its solver. Contains the numbers of the poses, because an index may mean
// different poses in two motions.
using Problem = std::tuple<std::string, std::vector<double>, std::string, std::string, std::string, double, std::string,
                           double, double>;

// Returns the numbers of both poses, for a map key. Replaces NaN, which only a damaged file contains, with infinity,
// because a map cannot order NaN.
std::vector<double> pose_numbers(const Case& c) {
    std::vector<double> all;
    for (const Pose* pose : {&c.pose, &c.target_pose}) {
        for (const double x : pose->rotation.reshaped()) all.push_back(std::isnan(x) ? HUGE_VAL : x);
        for (const double x : pose->translation) all.push_back(std::isnan(x) ? HUGE_VAL : x);
    }
    return all;
}

Problem problem_in(const Case& c) {
    return {c.scene,     pose_numbers(c), c.source, c.target, std::string(to_string(c.quantity)) + suffix_of(c),
            c.tolerance, c.tolerance_of,  c.floor,  c.cutoff};
}

// Returns the scene, pose and tolerance of a case as text.
std::string place_of(const Case& c) {
    return fmt::format("{}{}, pose {}, tolerance {:g}{}", c.scene, suffix_of(c), c.pose_index, c.tolerance,
                       c.tolerance_of == "diagonal" ? "" : " " + c.tolerance_of);
}

std::string interval_text(const Outcome& o) {
    return fmt::format("{} [{:.17g}, {:.17g}]", to_string(o.status), o.bounds.lower, o.bounds.upper);
}

bool answered(const Outcome& o) { return !std::isnan(o.bounds.lower) && !std::isnan(o.bounds.upper); }

bool overlap(const Bounds& a, const Bounds& b) { return a.lower <= b.upper && b.lower <= a.upper; }

std::vector<const Row*> rows_of(const ResultFile& result, const std::string& name) {
    std::vector<const Row*> rows;
    for (const std::size_t row : chosen_rows(result, {{name}, {}, {}})) rows.push_back(&result.rows[row]);
    return rows;
}

using Pairs = std::vector<std::pair<const Row*, const Row*>>;

Pairs pairs_of(const std::vector<const Row*>& first, const std::vector<const Row*>& second) {
    std::map<Problem, std::vector<const Row*>> answers;
    for (const Row* row : second) answers[problem_in(row->spec)].push_back(row);
    Pairs pairs;
    for (const Row* row : first) {
        const auto at = answers.find(problem_in(row->spec));
        if (at == answers.end()) continue;
        // If some rows of the other solver have the same swept parameters, only these are partners of this row.
        const auto same = [&](const Row* other) { return other->spec.variant == row->spec.variant; };
        const bool both_sweep = std::any_of(at->second.begin(), at->second.end(), same);
        for (const Row* other : at->second) {
            if ((!both_sweep || same(other)) && share_profile(row->spec.profile, other->spec.profile))
                pairs.emplace_back(row, other);
        }
    }
    return pairs;
}

// Returns the scene, pose and tolerance of a pair of rows as text. If `several` is set, because a solver has rows with
// different parameters, the text starts with both solvers.
std::string names_of(const Row& a, const Row& b, bool several) {
    return printable(several ? fmt::format("{} and {}, {}", shown(a.spec), shown(b.spec), place_of(a.spec))
                             : place_of(a.spec));
}

std::string ratio_text(const Estimate& ratio) {
    return ratio.n == 0
               ? ""
               : fmt::format("{} {:.3g} [{:.3g}, {:.3g}]", verdict_of(ratio), ratio.value, ratio.low, ratio.high);
}

struct Ratios {
    TextTable table{{{"case", false, 0, true},
                     {"solve again", true},
                     {"prepare and first answer", true, 1},
                     {"rounds", true, 2},
                     {"clock", false, 3}}};
    std::vector<double> again, total;
    std::size_t untimed = 0;
    std::map<std::string, std::size_t> apart;  // reason why times are not comparable -> number of pairs

    void add(const Row& a, const Row& b, const Programs& programs, const std::string& name) {
        const bool cpu = cpu_clock(a.outcome);
        const std::string why = reason_apart(origin_of(a.outcome, programs.of(a.outcome.build)),
                                             origin_of(b.outcome, programs.of(b.outcome.build)));
        if (!why.empty()) {
            ++apart[why];
            return;
        }
        const Estimate once = ratio_by_round(total_by_round(a.outcome, cpu), total_by_round(b.outcome, cpu));
        const Estimate repeated = ratio_by_round(again_by_round(a.outcome, cpu), again_by_round(b.outcome, cpu));
        if (once.n == 0 && repeated.n == 0) {
            ++untimed;
            return;
        }
        if (once.n > 0) total.push_back(once.value);
        if (repeated.n > 0) again.push_back(repeated.value);
        table.add({{name, ratio_text(repeated), ratio_text(once), std::to_string(std::max(once.n, repeated.n)),
                    cpu ? "CPU" : "wall"}});
    }
};

}  // namespace

std::string compare_solvers(const ResultFile& result, const std::string& first, const std::string& second,
                            const Paper& paper) {
    const auto of_first = rows_of(result, first), of_second = rows_of(result, second);
    const Pairs pairs = pairs_of(of_first, of_second);
    if (pairs.empty())
        throw InputError(
            fmt::format("'{}' and '{}' have no profile, scene, pose and tolerance in common", first, second));
    std::set<const Row*> paired;
    std::set<std::string> variants;
    for (const auto& [a, b] : pairs) {
        paired.insert({a, b});
        variants.insert({"1" + a->spec.variant, "2" + b->spec.variant});
    }
    const auto alone = [&](const std::vector<const Row*>& rows) {
        return std::count_if(rows.begin(), rows.end(), [&](const Row* row) { return !paired.contains(row); });
    };
    std::string apart, silent;
    std::size_t overlapping = 0;
    const Programs programs(result.texts);
    Ratios ratios;
    for (const auto& [a, b] : pairs) {
        const std::string name = names_of(*a, *b, variants.size() > 2);
        const std::string both =
            fmt::format("{}: {} {}, {} {}", name, first, interval_text(a->outcome), second, interval_text(b->outcome));
        if (!answered(a->outcome) || !answered(b->outcome))
            silent += wrapped(both, 2, paper.width);
        else if (!overlap(a->outcome.bounds, b->outcome.bounds))
            apart += wrapped(both, 2, paper.width);
        else
            ++overlapping;
        if (answered(a->outcome) && answered(b->outcome)) ratios.add(*a, *b, programs, name);
    }
    std::string text =
        wrapped(fmt::format("{} pairs of {} and {}; rows without a partner: {} of {}, {} of {}", pairs.size(), first,
                            second, alone(of_first), first, alone(of_second), second),
                0, paper.width);
    text += apart.empty() ? fmt::format("intervals: all {} overlap\n", overlapping)
                          : coloured("INTERVALS THAT DO NOT OVERLAP", Colour::red, paper) + "\n" + apart;
    if (!silent.empty()) text += "WITHOUT AN ANSWER\n" + silent;
    text += wrapped(fmt::format("time of {} / time of {}, round by round: solving again, and preparing with the first "
                                "answer ({} pairs without times)",
                                second, first, ratios.untimed),
                    0, paper.width);
    text += ratios.table.text(paper);
    for (const auto& [why, cases] : ratios.apart)
        text += wrapped(fmt::format("{} pairs without a ratio: their times are {}", cases, why), 0, paper.width);
    for (const auto& [what, all] :
         {std::pair("solving again", &ratios.again), std::pair("preparing and the first answer", &ratios.total)}) {
        if (!all->empty())
            text += wrapped(
                fmt::format("geometric mean of {} over {} pairs: {:.4g}", what, all->size(), geometric_mean(*all)), 0,
                paper.width);
    }
    return text;
}

}  // namespace hausbench
