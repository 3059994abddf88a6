#include "combine.h"

#include "error.h"
#include "shape_file.h"
#include "statistics.h"
#include "verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace hausbench {

namespace fs = std::filesystem;

std::vector<std::string> verify_result(ResultFile& result, const Catalogue& catalogue) {
    std::map<std::string, Shape> shapes;
    std::vector<std::string> missing;
    for (const ModelRecord& model : result.models) {
        const auto resolved = catalogue.resolve(model.name);
        if (const auto* absent = std::get_if<MissingModel>(&resolved)) {
            missing.push_back(
                fmt::format("model '{}' is not here, so its rows are not checked: {}", model.name, absent->reason));
            continue;
        }
        const auto& good = std::get<ResolvedModel>(resolved);
        if (good.content_hash != model.sha256) {
            throw InputError(fmt::format(
                "model '{}': SHA-256 {} was measured, {} is here now: check out the manifest that the result was "
                "made with",
                model.name, model.sha256, good.content_hash));
        }
        shapes[model.name] = read_shape(good.shape_file).shape;
    }
    verify_rows(result.rows, [&](const std::string& name) -> const Shape* {
        const auto at = shapes.find(name);
        return at == shapes.end() ? nullptr : &at->second;
    });
    return missing;
}

bool any_unsound(const ResultFile& result) {
    return std::any_of(result.rows.begin(), result.rows.end(), [](const Row& row) {
        return row.check.lower == Verdict::unsound || row.check.upper == Verdict::unsound ||
               row.check.fields == Verdict::unsound;
    });
}

namespace {

bool was_run(const Outcome& o) {
    return (o.status != RowStatus::skipped && o.status != RowStatus::not_built) || !o.solver_status.empty();
}

// Which case of the experiment it is. Not the identity, which holds the shapes' hashes: a machine without a model has none.
// One that lacks the solver knows only the parameters that are given: options are therefore compared apart.
std::string place_of(const Case& c) {
    return nlohmann::json({c.scene, c.source, c.target, c.label, c.solver, c.pose_index, number(c.tolerance),
                           c.tolerance_of, to_string(c.quantity), c.warm})
        .dump();
}

bool same_options(const Row& a, const Row& b) {
    const auto within = [](const ParameterMap& few, const ParameterMap& many) {
        return std::all_of(few.begin(), few.end(),
                           [&](const auto& o) { return many.contains(o.first) && many.at(o.first) == o.second; });
    };
    if (a.outcome.status == RowStatus::not_built) return within(a.asked.options, b.asked.options);
    if (b.outcome.status == RowStatus::not_built) return within(b.asked.options, a.asked.options);
    return a.asked.options == b.asked.options;
}

bool same_answer(const Outcome& a, const Outcome& b) {
    const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
    return a.status == b.status && same(a.bounds.lower, b.bounds.lower) && same(a.bounds.upper, b.bounds.upper);
}

}  // namespace

std::string describe_checks(const ResultFile& result) {
    std::map<std::string, std::map<Verdict, int>> lower, upper;
    for (const Row& row : result.rows) {
        ++lower[row.asked.label][row.check.lower];
        ++upper[row.asked.label][row.check.upper];
    }
    std::string text = fmt::format("{:<16} {:>8} {:>8} {:>8} {:>8} | {:>8} {:>8} {:>8}\n", "lower bound of", "holds",
                                   "unsound", "no wit.", "not ch.", "upper ok", "unsound", "not ch.");
    for (auto& [label, l] : lower) {
        auto& u = upper[label];
        text += fmt::format("{:<16} {:>8} {:>8} {:>8} {:>8} | {:>8} {:>8} {:>8}\n", label, l[Verdict::holds],
                            l[Verdict::unsound], l[Verdict::no_witness], l[Verdict::not_checked], u[Verdict::holds],
                            u[Verdict::unsound], u[Verdict::not_checked]);
    }
    std::map<Verdict, int> fields;
    for (const Row& row : result.rows) {
        if (!row.fields.empty()) ++fields[row.check.fields];
    }
    if (!fields.empty())
        text += fmt::format("fields of cases: {} hold, {} unsound, {} not checked\n", fields[Verdict::holds],
                            fields[Verdict::unsound], fields[Verdict::not_checked]);
    for (const Row& row : result.rows) {
        if (!row.check.reason.empty()) text += fmt::format("unsound: {}: {}\n", name_of(row.asked), row.check.reason);
    }
    return text;
}

ResultFile merge_results(const std::vector<fs::path>& files, bool any_build) {
    ResultFile merged = read_result(files.front());
    std::map<std::string, std::vector<std::size_t>> places;
    for (std::size_t i = 0; i < merged.rows.size(); ++i) places[place_of(merged.rows[i].asked)].push_back(i);
    for (std::size_t f = 1; f < files.size(); ++f) {
        const ResultFile next = read_result(files[f]);
        const auto refuse = [&](const std::string& what) {
            throw InputError(fmt::format("{} and {}: {}", files.front().string(), files[f].string(), what));
        };
        for (const char* name : {"stem", "profile", "experiment_toml"}) {
            if (next.texts.at(name) != merged.texts.at(name))
                refuse(fmt::format("their {} differs: merge results of one experiment", name));
        }
        for (const char* name : {"build", "machine"}) {
            if (!any_build && next.texts.at(name) != merged.texts.at(name)) {
                refuse(fmt::format(
                    "made by different {}s: times would not compare; merge with --any-build if that is meant", name));
            }
        }
        merged.texts["started"] = std::min(merged.texts["started"], next.texts.at("started"));
        merged.texts["finished"] = std::max(merged.texts["finished"], next.texts.at("finished"));
        for (const Row& row : next.rows) {
            std::vector<std::size_t>& here = places[place_of(row.asked)];
            bool found = false;
            for (std::size_t i : here) {
                Row& mine = merged.rows[i];
                if (!same_options(mine, row)) continue;
                found = true;
                if (!was_run(row.outcome)) continue;
                if (!was_run(mine.outcome)) {
                    mine = row;
                } else if (mine.asked.identity != row.asked.identity) {
                    refuse(fmt::format("they asked for different things at {}: another model or limit",
                                       name_of(row.asked)));
                } else if (!same_answer(mine.outcome, row.outcome)) {
                    refuse(fmt::format("different answers to {}: {} [{}, {}] and {} [{}, {}]", name_of(row.asked),
                                       to_string(mine.outcome.status), mine.outcome.bounds.lower,
                                       mine.outcome.bounds.upper, to_string(row.outcome.status),
                                       row.outcome.bounds.lower, row.outcome.bounds.upper));
                }
            }
            if (found) continue;
            here.push_back(merged.rows.size());
            merged.rows.push_back(row);
        }
        for (const ModelRecord& model : next.models) {
            const auto same = [&](const ModelRecord& m) { return m.name == model.name; };
            if (std::none_of(merged.models.begin(), merged.models.end(), same)) merged.models.push_back(model);
        }
        for (const LedgerEntry& entry : next.ledger) {
            const auto same = [&](const LedgerEntry& l) {
                return l.kind == entry.kind && l.subject == entry.subject && l.what == entry.what;
            };
            const auto at = std::find_if(merged.ledger.begin(), merged.ledger.end(), same);
            if (at == merged.ledger.end())
                merged.ledger.push_back(entry);
            else if (std::isnan(at->seconds_saved))
                at->seconds_saved = entry.seconds_saved;  // one part ran it, the others did not
        }
    }
    return merged;
}

std::string compare_results(const ResultFile& base, const ResultFile& candidate) {
    std::map<std::string, const Row*> by_key;
    for (const Row& row : base.rows) by_key[row.asked.identity + row.asked.scene] = &row;
    std::string differing, table;
    std::size_t matched = 0, untimed = 0;
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
        const char* verdict = ratio.n == 1              ? "one pair"
                              : ratio.confidence < 0.95 ? "too few pairs"
                              : !separated(ratio)       ? "not separated"
                              : ratio.value > 1         ? "slower"
                                                        : "faster";
        table += fmt::format("  {:<60} {:>8.4g} [{:.4g}, {:.4g}]  n = {:<3} {:>5.1f} %  {:<4}  {}\n",
                             name_of(row.asked), ratio.value, ratio.low, ratio.high, ratio.n, 100 * ratio.confidence,
                             cpu ? "CPU" : "wall", verdict);
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
    text +=
        fmt::format(
            "time of the second / time of the first, median of paired repeats [interval], CPU or wall time ({} cases "
            "without times)\n",
            untimed) +
        table;
    if (!all.empty()) {
        double logs = 0;
        for (double ratio : all) logs += std::log(ratio);
        text +=
            fmt::format("  geometric mean over {} cases: {:.4g}\n", all.size(), std::exp(logs / double(all.size())));
    }
    return text;
}

}  // namespace hausbench
