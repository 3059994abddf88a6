// `hausbench merge`: joins several results of one experiment, such as shards.
#include "algorithms/error.h"
#include "harness/commands/comparison.h"
#include "harness/commands/verb.h"
#include "harness/commands/verify_result.h"
#include "harness/plan/plan.h"
#include "harness/record/json.h"
#include "harness/record/profiles.h"
#include "harness/result/result_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

bool was_run(const Outcome& o) {
    return (o.status != RowStatus::skipped && o.status != RowStatus::not_built) || !o.solver_status.empty();
}

// Returns a key that identifies the case within its experiment. Unlike Case::identity, it omits the hashes of the
// shapes, because a machine without the model does not know them. It also omits the options, because a machine without
// the solver knows only some of them; same_options() compares them.
std::string place_of_case(const Case& c) {
    return nlohmann::json({c.scene, c.source, c.target, c.label, c.solver, c.pose_index, number(c.tolerance),
                           c.tolerance_of, to_string(c.quantity), c.statistic, to_string(c.weigh), c.warm})
        .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// Returns whether two rows have the same options. A row whose solver is not built has only the parameters given in the
// experiment, so the other row need only contain these.
bool same_options(const Row& a, const Row& b) {
    const auto within = [](const ParameterMap& few, const ParameterMap& many) {
        return std::all_of(few.begin(), few.end(),
                           [&](const auto& o) { return many.contains(o.first) && many.at(o.first) == o.second; });
    };
    if (a.outcome.status == RowStatus::not_built) return within(a.spec.options, b.spec.options);
    if (b.outcome.status == RowStatus::not_built) return within(b.spec.options, a.spec.options);
    return a.spec.options == b.spec.options;
}

// Parses the attribute `shard` of a result: "1/3, 2/3" gives the pairs (3, 1) and (3, 2). Returns no pairs for a
// complete, old or damaged result.
std::set<std::pair<int, int>> shards_in(const std::string& text) {
    std::set<std::pair<int, int>> shards;
    std::istringstream in(text);
    for (std::string part; std::getline(in >> std::ws, part, ',');) {
        try {
            const Shard shard = parse_shard(part);
            shards.insert({shard.of, shard.number});
        } catch (const InputError&) {  // a damaged file
            return {};
        }
    }
    return shards;
}

// Returns the shards of two results together, as text. Returns an empty string if no shard is missing, or if one of the
// results is complete.
std::string both_shards(const std::string& one, const std::string& other) {
    std::set<std::pair<int, int>> shards = shards_in(one), more = shards_in(other);
    if (shards.empty() || more.empty()) return "";
    shards.insert(more.begin(), more.end());
    std::map<int, int> counts;
    std::string text;
    for (const auto& [of, number] : shards) {
        text += fmt::format("{}{}/{}", text.empty() ? "" : ", ", number, of);
        if (++counts[of] == of) return "";
    }
    return text;
}

// Merges results into the first one. Errors name the first file and the one being added.
class Merger {
public:
    Merger(ResultFile first, const fs::path& file) : merged_(std::move(first)), first_(file) {
        for (std::size_t i = 0; i < merged_.rows.size(); ++i) places_[place_of_case(merged_.rows[i].spec)].push_back(i);
    }

    void add(const ResultFile& next, const fs::path& file, bool any_build) {
        file_ = file;
        for (const char* name : {"stem", "profile", "experiment_toml"}) {
            if (next.texts.at(name) != merged_.texts.at(name))
                refuse(fmt::format("their {} differs: merge results of one experiment", name));
        }
        for (const char* name : {"build", "machine"}) {
            if (!any_build && next.texts.at(name) != merged_.texts.at(name)) {
                refuse(fmt::format(
                    "made by different {}s, so their times are not comparable: add --any-build to merge them anyway",
                    name));
            }
        }
        merged_.texts["shard"] = both_shards(merged_.texts["shard"], next.texts.at("shard"));
        merged_.texts["started"] = std::min(merged_.texts["started"], next.texts.at("started"));
        merged_.texts["finished"] = std::max(merged_.texts["finished"], next.texts.at("finished"));
        const std::set<std::string> unlike = unlike_models(merged_, next);
        std::size_t left_out = 0;
        for (const Row& row : next.rows) {
            if (!is_of(row.spec, unlike))
                add(row);
            else if (was_run(row.outcome))
                ++left_out;
        }
        if (left_out > 0)
            notes_.push_back(
                fmt::format("{}: {} of its cases are left out, because their models are other shapes in {}: {}",
                            file_.string(), left_out, first_.string(), fmt::join(unlike, ", ")));
        add_references(next, unlike);
        for (const ModelRecord& model : next.models) {
            const auto same = [&](const ModelRecord& m) { return m.name == model.name; };
            if (std::none_of(merged_.models.begin(), merged_.models.end(), same)) merged_.models.push_back(model);
        }
        for (const LedgerEntry& entry : next.ledger) add(entry);
    }

    // Returns the merged result, which leaves this object empty.
    ResultFile result() && { return std::move(merged_); }
    // Returns a line for each result of which some cases were left out.
    const std::vector<std::string>& notes() const { return notes_; }

private:
    [[noreturn]] void refuse(const std::string& what) const {
        throw InputError(fmt::format("{} and {}: {}", first_.string(), file_.string(), what));
    }

    void add(const Row& row) {
        std::vector<std::size_t>& here = places_[place_of_case(row.spec)];
        bool matched = false;
        for (std::size_t i : here) {
            Row& mine = merged_.rows[i];
            if (!same_options(mine, row) || !share_profile(mine.spec.profile, row.spec.profile)) continue;
            matched = true;
            const std::string profiles = joined_profiles(mine.spec.profile, row.spec.profile);
            if (was_run(row.outcome)) join(mine, row);
            mine.spec.profile = profiles;
        }
        if (matched) return;
        here.push_back(merged_.rows.size());
        merged_.rows.push_back(row);
    }

    // Adds the reference answers that `merged_` lacks, except answers for the `unlike` models. merge() checks the rows
    // against all of them afterwards.
    void add_references(const ResultFile& next, const std::set<std::string>& unlike) {
        std::set<std::string> identities;
        for (const Row& reference : merged_.references) identities.insert(reference.spec.identity);
        for (const Row& reference : next.references)
            if (!is_of(reference.spec, unlike) && identities.insert(reference.spec.identity).second)
                merged_.references.push_back(reference);
    }

    // Joins two rows of one case; `row` was run. Replaces `mine` if it was not run. Otherwise checks that both have the
    // same identity and answer.
    void join(Row& mine, const Row& row) const {
        const Outcome &a = mine.outcome, &b = row.outcome;
        if (!was_run(a)) {
            mine = row;
        } else if (mine.spec.identity != row.spec.identity) {
            refuse(fmt::format("they requested different things at {}: another program or limit", name_of(row.spec)));
        } else if (!same_answer(a, b)) {
            refuse(fmt::format("different answers to {}: {} [{}, {}] and {} [{}, {}]", name_of(row.spec),
                               to_string(a.status), a.bounds.lower, a.bounds.upper, to_string(b.status), b.bounds.lower,
                               b.bounds.upper));
        }
    }

    void add(const LedgerEntry& entry) {
        const auto same = [&](const LedgerEntry& l) {
            return l.kind == entry.kind && l.subject == entry.subject && l.what == entry.what &&
                   l.profile == entry.profile;
        };
        const auto at = std::find_if(merged_.ledger.begin(), merged_.ledger.end(), same);
        if (at == merged_.ledger.end()) {
            merged_.ledger.push_back(entry);
        } else if (entry.kind == "reference") {  // each part computed references of its own
            at->count += entry.count;
            at->seconds_saved += entry.seconds_saved;
        } else if (std::isnan(at->seconds_saved)) {
            at->seconds_saved = entry.seconds_saved;  // one part ran it, the others did not
        }
    }

    ResultFile merged_;
    fs::path first_, file_;
    std::vector<std::string> notes_;
    std::map<std::string, std::vector<std::size_t>> places_;
};

// Merges results of the same experiment and profile, such as shards. For each case, keeps a row that was run if there
// is one, because another machine may have lacked the model or solver. Leaves out the cases of a model that is another
// shape in an earlier result, and says so. Throws InputError if the experiments differ, if the builds or machines differ
// (unless `any_build`), or if two rows of a case have different answers.
ResultFile merge_results(const std::vector<fs::path>& files, bool any_build) {
    Merger merger(read_result(files.front()), files.front());
    for (std::size_t f = 1; f < files.size(); ++f) merger.add(read_result(files[f]), files[f], any_build);
    say(merger.notes());
    return std::move(merger).result();
}

// Returns a line that names the shards missing from a result. Returns an empty string if no case is in a missing shard.
std::string missing_shards(const ResultFile& merged) {
    const auto elsewhere = std::count_if(merged.rows.begin(), merged.rows.end(), [](const Row& row) {
        return row.outcome.status == RowStatus::skipped && row.outcome.reason == in_another_shard;
    });
    const auto shards = shards_in(merged.texts.at("shard"));
    if (elsewhere == 0) return "";
    std::string missing, remedy = "run the others and merge again";
    constexpr int most_named = 100;
    if (!shards.empty() && shards.begin()->first == shards.rbegin()->first && shards.begin()->first <= most_named) {
        const int of = shards.begin()->first;
        for (int number = 1; number <= of; ++number) {
            if (!shards.contains({of, number}))
                missing += fmt::format("{}{}/{}", missing.empty() ? "" : ", ", number, of);
        }
        remedy = "run them with --shard and merge again";
    }
    return fmt::format("{} of {} cases are in shards that are missing{}: {}", elsewhere, merged.rows.size(),
                       missing.empty() ? "" : ", " + missing, remedy);
}

// Returns whether `old` is an earlier merge of some of the shards in `now`, so that nothing is lost if it is replaced. One
// shard alone is not: its name was given first by mistake.
bool is_earlier_merge(const ResultFile& old, const ResultFile& now) {
    const auto same = [&](const char* name) { return old.texts.at(name) == now.texts.at(name); };
    if (!same("stem") || !same("profile") || !same("experiment_toml")) return false;
    const auto before = shards_in(old.texts.at("shard")), after = shards_in(now.texts.at("shard"));
    const bool complete = missing_shards(now).empty();
    return before.size() >= 2 && (complete || std::includes(after.begin(), after.end(), before.begin(), before.end()));
}

int merge(const fs::path& out, const std::vector<fs::path>& parts, bool any_build) {
    if (parts.size() < 2)
        throw InputError("merge: needs at least two results: name the file to write first, then two or more results");
    std::error_code none;
    const auto is_out = [&](const fs::path& part) { return fs::equivalent(part, out, none); };
    ResultFile result = merge_results(parts, any_build);
    if (fs::exists(out, none) && std::none_of(parts.begin(), parts.end(), is_out) &&
        !is_earlier_merge(read_result(out), result))
        throw InputError(fmt::format(
            "{}: exists and is not one of the results to merge: name a new file first, or remove it", out.string()));
    say(verify_result(result, catalogue()));  // a lower bound in one part may refute an upper bound in another
    write_result(out, result);
    print(fmt::format("{}: {} cases of {} results\n", out.string(), result.rows.size(), parts.size()));
    const std::string missing = missing_shards(result);
    if (!missing.empty()) say({missing});
    return missing.empty() ? 0 : 1;
}

}  // namespace

void add_merge(CLI::App& app, int& code) {
    static fs::path out;
    static std::vector<fs::path> parts;
    static bool any_build = false;
    auto* verb = add_verb(app, "merge", "joins results of one experiment, such as shards",
                          "hausbench merge all.h5 part1.h5 part2.h5", "Exit code 1: a shard is missing.");
    verb->add_option("out", out, "result file to write (.h5)")->type_name("FILE")->required();
    verb->add_option("results", parts, "two or more result files")->type_name("FILE")->required();
    verb->add_flag("--any-build", any_build, "joins them even if they are of different builds or machines");
    verb->callback([&code] { code = merge(out, parts, any_build); });
}

}  // namespace hausbench
