#include "harness/run/earlier.h"

#include "algorithms/error.h"
#include "algorithms/printable.h"
#include "harness/record/profiles.h"
#include "harness/result/provenance.h"
#include "process/interrupts.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <system_error>
#include <tuple>

namespace hausbench {

namespace {

using CaseKey = std::tuple<std::string, std::string, std::string>;

CaseKey key_of(const Case& c) { return {c.identity, c.scene, c.label}; }

// The cases that the experiment now requests in one profile.
struct Asked {
    std::map<CaseKey, Case> cases;
    std::set<std::string> unknown;  // scenes with unknown poses, see AskedCases
};

class Keeper {
public:
    Keeper(ResultFile& result, ResultFile& before, const Plan& plan, const ShapesOf& shapes_of,
           std::vector<std::size_t>& places)
        : result_(result),
          before_(before),
          shapes_of_(shapes_of),
          plan_(plan),
          places_(places),
          now_(plan.experiment.profile) {
        std::map<std::string, std::string> matrices;
        for (const ScenePlan& scene : plan.experiment.scenes) matrices[scene.name] = scene.matrix;
        for (std::size_t i = 0; i < plan.cases.size(); ++i) {
            const Case& c = plan.cases[i];
            rows_[key_of(c)] = i;
            covered_.insert({c.scene, c.label});
            for (const std::string& scene : {c.scene, matrices[c.scene]})
                if (!scene.empty())
                    subjects_.insert(fmt::format("{} on {}{}", shown(c), scene, suffix_of_statistic(c)));
        }
        for (const ModelRecord& model : result.models) hashes_[model.name] = model.sha256;
        recorded_ = result.models;
        for (const ModelRecord& model : before.models)
            if (!hashes_.contains(model.name)) recorded_.push_back(model);
    }

    std::vector<std::string> keep() {
        const std::size_t requested = result_.rows.size();
        for (std::size_t i = 0; i < requested; ++i) places_.push_back(plan_.whole ? i : before_.rows.size() + i);
        decide_profiles();
        for (std::size_t i = 0; i < before_.rows.size(); ++i) {
            place_ = plan_.whole ? requested + i : i;
            keep(std::move(before_.rows[i]));
        }
        for (ModelRecord& model : before_.models) {
            if (models_.contains(model.name) && !hashes_.contains(model.name))
                result_.models.push_back(std::move(model));
        }
        keep_references();
        for (LedgerEntry& entry : before_.ledger) {
            const bool mine = entry.profile == now_ && (plan_.whole || subjects_.contains(entry.subject));
            if (!mine && profiles_.contains(entry.profile)) result_.ledger.push_back(std::move(entry));
        }
        return said();
    }

private:
    // Keeps earlier reference answers that rows of the result need, unless this run has computed them anew.
    void keep_references() {
        if (!plan_.experiment.reference) return;
        using Place = std::tuple<std::string, Quantity, int>;  // scene, quantity, pose; statistics have no references
        const auto place_of = [](const Case& c) { return Place(c.scene, c.quantity, c.pose_index); };
        std::set<Place> wanted;
        for (const Row& row : result_.rows) wanted.insert(place_of(row.spec));
        for (const Row& reference : result_.references) wanted.erase(place_of(reference.spec));
        for (Row& reference : before_.references)
            if (wanted.contains(place_of(reference.spec))) result_.references.push_back(std::move(reference));
    }

    // Returns whether an interrupted run ended before it reached this row.
    static bool awaits(const Row& row) {
        return row.outcome.status == RowStatus::skipped && row.outcome.reason == not_run_yet;
    }

    // Returns whether this run will replace the row that an earlier run in the same profile wrote for the case.
    bool covers(const Case& c) const { return plan_.whole || covered_.contains({c.scene, c.label}); }

    // Sets `asked_` to the cases that the experiment now requests, for each profile with an earlier row that the plan
    // does not replace. A profile that can no longer be read requests nothing; a run in that profile reports the error.
    void decide_profiles() {
        for (const Row& row : before_.rows) {
            for (const std::string& profile : uncovered(row.spec)) {
                if (asked_.contains(profile)) continue;
                Asked& requested = asked_[profile];
                try {
                    const Experiment experiment =
                        profile == now_ ? plan_.experiment : in_profile(plan_.experiment, profile);
                    AskedCases planned = cases_as_recorded(experiment, recorded_, shapes_of_(experiment));
                    for (Case& c : planned.cases) {
                        CaseKey k = key_of(c);
                        requested.cases.emplace(std::move(k), std::move(c));
                    }
                    requested.unknown = std::move(planned.unknown);
                } catch (const InputError&) {
                }
            }
        }
    }

    // Returns the profiles in which the plan does not replace the earlier row of this case.
    std::set<std::string> uncovered(const Case& c) const {
        std::set<std::string> profiles = profile_names(c.profile);
        if (covers(c)) profiles.erase(now_);
        return profiles;
    }

    // Keeps or drops an earlier row by the rules of keep_earlier().
    void keep(Row row) {
        Case& c = row.spec;
        const auto at = rows_.find(key_of(c));
        if (at != rows_.end() && !plan_.whole) places_[at->second] = place_;
        if (at != rows_.end() && awaits(result_.rows[at->second]) && !awaits(row)) {
            Row& replaced = result_.rows[at->second];
            replaced.outcome = std::move(row.outcome);
            replaced.check = row.check;
            replaced.fields = std::move(row.fields);
            ++not_replaced_;
        }
        std::set<std::string> profiles = uncovered(c);
        if (profiles.empty()) return;
        for (const auto& [name, hash] : {std::pair(c.source, c.source_hash), std::pair(c.target, c.target_hash)}) {
            const auto now = hashes_.find(name);
            if (now == hashes_.end() || hash.empty() || now->second == hash) continue;
            ++changed_[name];
            return;
        }
        const Case* today = nullptr;
        std::erase_if(profiles, [&](const std::string& profile) {
            const Asked& requested = asked_.at(profile);
            const auto match = requested.cases.find(key_of(c));
            if (match != requested.cases.end()) today = &match->second;
            return match == requested.cases.end() && !requested.unknown.contains(c.scene);
        });
        if (profiles.empty()) {
            ++gone_;
            return;
        }
        if (at != rows_.end()) {
            std::string& both = result_.rows[at->second].spec.profile;
            both = joined_profiles(both, joined_profiles(profiles));
            return;
        }
        if (today) describe_as(*today, c);
        c.profile = joined_profiles(profiles);
        profiles_.merge(profiles);
        models_.insert({c.source, c.target});
        if (!row.outcome.build.empty() && row.outcome.build != build_of(c.solver)) ++other_builds_;
        places_.push_back(place_);
        result_.rows.push_back(std::move(row));
    }

    // Updates the properties of an earlier case that the experiment may have changed without changing the case's
    // identity.
    static void describe_as(const Case& today, Case& c) {
        c.variant = today.variant;
        c.note = today.note;
        c.exact = today.exact;
        c.family = today.family;
        c.severity = today.severity;
        c.pose_index = today.pose_index;
    }

    std::vector<std::string> said() const {
        std::vector<std::string> lines;
        if (gone_ > 0)
            lines.push_back(fmt::format(
                "{} earlier rows are left out: the experiment no longer asks for these cases (scene, solver, "
                "parameters, tolerance, motion, limits, or the program of `external`)",
                gone_));
        if (not_replaced_ > 0)
            lines.push_back(fmt::format("{} rows were not measured again: the earlier ones stay", not_replaced_));
        for (const auto& [name, rows] : changed_)
            lines.push_back(
                fmt::format("{} earlier rows are left out: model '{}' has changed; run them again", rows, name));
        if (other_builds_ > 0)
            lines.push_back(
                fmt::format("{} earlier rows are of another build (column `build`): run them again to compare times",
                            other_builds_));
        return lines;
    }

    ResultFile &result_, &before_;
    const ShapesOf& shapes_of_;
    std::vector<ModelRecord> recorded_;  // models of the plan and of earlier rows
    const Plan& plan_;
    std::vector<std::size_t>& places_;
    std::size_t place_ = 0;  // sort key of the earlier row in keep()
    const std::string now_;
    std::map<CaseKey, std::size_t> rows_;
    std::set<std::pair<std::string, std::string>> covered_;  // scene, label
    std::set<std::string> subjects_;                         // subjects of ledger entries about the plan's rows
    std::map<std::string, std::string> hashes_;              // of the models of the plan
    std::map<std::string, Asked> asked_;                     // by profile
    std::set<std::string> profiles_, models_;                // of rows that stay
    std::map<std::string, std::size_t> changed_;
    std::size_t gone_ = 0, not_replaced_ = 0, other_builds_ = 0;
};

// Renames a file to FILE.unreadable or, if that name is taken, to FILE.unreadable.2 and so on.
std::filesystem::path put_aside(const std::filesystem::path& file) {
    std::filesystem::path aside = file.string() + ".unreadable";
    for (int number = 2; std::filesystem::exists(std::filesystem::symlink_status(aside)); ++number)
        aside = fmt::format("{}.unreadable.{}", file.string(), number);
    std::filesystem::rename(file, aside);
    return aside;
}

}  // namespace

std::vector<std::string> keep_earlier(ResultFile& result, ResultFile before, const Plan& plan,
                                      const ShapesOf& shapes_of, std::vector<std::size_t>& places) {
    return Keeper(result, before, plan, shapes_of, places).keep();
}

std::vector<std::string> keep_earlier_rows(ResultFile& result, const std::filesystem::path& file, const Plan& plan,
                                           const ShapesOf& shapes_of, std::vector<std::size_t>& places) {
    std::error_code loop;  // set if there are too many links: such a file is replaced
    if (!std::filesystem::exists(file, loop)) return {};
    try {
        return keep_earlier(result, read_result(file), plan, shapes_of, places);
    } catch (const NewerResult&) {
        throw;  // the finished cases are safe in the journal
    } catch (const InputError& error) {
        if (HoldInterrupts::came()) throw;  // Ctrl-C ended the reading; the file may be intact
        return {fmt::format("{}; it is {} now", error.what(), put_aside(file).string())};
    }
}

void refuse_to_replace(const std::filesystem::path& file, const Experiment& experiment, bool fresh) {
    const EarlierExperiment earlier = experiment_of(file);
    std::error_code gone;
    if (fresh || earlier.file.empty() || earlier.toml == experiment.toml ||
        !std::filesystem::exists(earlier.file, gone) ||
        std::filesystem::equivalent(earlier.file, experiment.file, gone))
        return;
    throw InputError(
        fmt::format("{}: is the result of another experiment of this name, {}: name another folder with --results, or "
                    "replace it with --fresh",
                    file.string(), printable(earlier.file)));
}

void put_in_order(std::vector<Row>& rows, const std::vector<std::size_t>& places) {
    std::vector<std::size_t> order(rows.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return places[a] < places[b]; });
    std::vector<Row> sorted;
    for (const std::size_t i : order) sorted.push_back(std::move(rows[i]));
    rows = std::move(sorted);
}

}  // namespace hausbench
