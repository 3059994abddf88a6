#include "run/earlier.h"

#include "error.h"
#include "record/profiles.h"
#include "result/provenance.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

namespace hausbench {

namespace {

// What an experiment asks for in a profile.
class Asked {
public:
    explicit Asked(Experiment experiment) : experiment_(std::move(experiment)) {
        for (const ScenePlan& scene : experiment_.scenes) models_[scene.name] = {scene.source, scene.target};
    }

    bool has(const Case& c) const {
        const auto models = models_.find(c.scene);
        return models != models_.end() && models->second == std::pair(c.source, c.target) &&
               c.tolerance_of == experiment_.of &&
               std::any_of(experiment_.solvers.begin(), experiment_.solvers.end(), [&](const SolverPlan& solver) {
                   const auto& tolerances = solver.tolerances;
                   return solver.label == c.label && solver.name == c.solver && solver.quantity == c.quantity &&
                          std::find(tolerances.begin(), tolerances.end(), c.tolerance) != tolerances.end();
               });
    }

private:
    Experiment experiment_;
    std::map<std::string, std::pair<std::string, std::string>> models_;  // of scenes
};

class Keeper {
public:
    Keeper(ResultFile& result, const Plan& plan, std::vector<std::size_t>& places)
        : result_(result), plan_(plan), places_(places), now_(plan.experiment.profile) {
        std::map<std::string, std::string> matrices;
        for (const ScenePlan& scene : plan.experiment.scenes) matrices[scene.name] = scene.matrix;
        for (std::size_t i = 0; i < plan.cases.size(); ++i) {
            const Case& c = plan.cases[i];
            rows_[key(c)] = i;
            covered_.insert({c.scene, c.label});
            subjects_.insert(fmt::format("{} on {}", shown(c), c.scene));
            if (!matrices[c.scene].empty()) subjects_.insert(fmt::format("{} on {}", shown(c), matrices[c.scene]));
        }
        for (const ModelRecord& model : result.models) hashes_[model.name] = model.sha256;
    }

    std::vector<std::string> keep(ResultFile before) {
        const std::size_t asked = result_.rows.size();
        for (std::size_t i = 0; i < asked; ++i) places_.push_back(plan_.whole ? i : before.rows.size() + i);
        for (std::size_t i = 0; i < before.rows.size(); ++i) {
            place_ = plan_.whole ? asked + i : i;
            keep(std::move(before.rows[i]));
        }
        for (ModelRecord& model : before.models) {
            if (models_.contains(model.name) && !hashes_.contains(model.name))
                result_.models.push_back(std::move(model));
        }
        for (LedgerEntry& entry : before.ledger) {
            const bool mine = entry.profile == now_ && (plan_.whole || subjects_.contains(entry.subject));
            if (!mine && profiles_.contains(entry.profile)) result_.ledger.push_back(std::move(entry));
        }
        return said();
    }

private:
    static std::tuple<std::string, std::string, std::string> key(const Case& c) {
        return {c.identity, c.scene, c.label};
    }

    static bool awaits(const Row& row) {
        return row.outcome.status == RowStatus::skipped && row.outcome.reason == not_run_yet;
    }

    bool covers(const Case& c) const { return plan_.whole || covered_.contains({c.scene, c.label}); }

    // Of the experiment as it is now; null where it can no longer be read in that profile.
    const Asked* asked_in(const std::string& profile) {
        auto at = asked_.find(profile);
        if (at == asked_.end()) {
            std::optional<Asked> asked;
            try {
                asked.emplace(profile == now_ ? plan_.experiment : read_experiment(plan_.experiment.file, profile));
            } catch (const InputError&) {  // nobody can ask for it; a run in that profile says why
            }
            at = asked_.emplace(profile, std::move(asked)).first;
        }
        return at->second ? &*at->second : nullptr;
    }

    void keep(Row row) {
        Case& c = row.asked;
        const auto at = rows_.find(key(c));
        if (at != rows_.end() && !plan_.whole) places_[at->second] = place_;
        if (at != rows_.end() && awaits(result_.rows[at->second]) && !awaits(row)) {
            Row& asked = result_.rows[at->second];
            asked.outcome = std::move(row.outcome), asked.check = row.check, asked.fields = std::move(row.fields);
            ++not_replaced_;
        }
        std::set<std::string> profiles = profile_names(c.profile);
        if (covers(c)) profiles.erase(now_);
        if (profiles.empty()) return;
        std::erase_if(profiles, [&](const std::string& profile) {
            const Asked* asked = asked_in(profile);
            return !asked || !asked->has(c);
        });
        if (profiles.empty()) {
            ++gone_;
            return;
        }
        for (const auto& [name, hash] : {std::pair(c.source, c.source_hash), std::pair(c.target, c.target_hash)}) {
            const auto now = hashes_.find(name);
            if (now == hashes_.end() || hash.empty() || now->second == hash) continue;
            ++changed_[name];
            return;
        }
        if (at != rows_.end()) {
            std::string& both = result_.rows[at->second].asked.profile;
            both = joined_profiles(both, joined_profiles(profiles));
            return;
        }
        c.profile = joined_profiles(profiles);
        profiles_.merge(profiles);
        models_.insert({c.source, c.target});
        if (!row.outcome.build.empty() && row.outcome.build != build_of(c.solver)) ++other_builds_;
        places_.push_back(place_);
        result_.rows.push_back(std::move(row));
    }

    std::vector<std::string> said() const {
        std::vector<std::string> lines;
        if (gone_ > 0)
            lines.push_back(fmt::format(
                "{} earlier rows are left out: the experiment no longer asks for their scene, solver or tolerance",
                gone_));
        if (not_replaced_ > 0)
            lines.push_back(
                fmt::format("{} rows were not measured again: those of the earlier run stay", not_replaced_));
        for (const auto& [name, rows] : changed_)
            lines.push_back(fmt::format("{} earlier rows are left out: model '{}' has other bytes now; run them again",
                                        rows, name));
        if (other_builds_ > 0)
            lines.push_back(fmt::format(
                "{} rows of an earlier run are of another build (column `build`): run them again to compare times",
                other_builds_));
        return lines;
    }

    ResultFile& result_;
    const Plan& plan_;
    std::vector<std::size_t>& places_;
    std::size_t place_ = 0;  // of the row at hand
    const std::string now_;
    std::map<std::tuple<std::string, std::string, std::string>, std::size_t> rows_;
    std::set<std::pair<std::string, std::string>> covered_;  // scene, label
    std::set<std::string> subjects_;                         // of the ledger
    std::map<std::string, std::string> hashes_;              // of the models of the plan
    std::map<std::string, std::optional<Asked>> asked_;
    std::set<std::string> profiles_, models_;  // of rows that stay
    std::map<std::string, std::size_t> changed_;
    std::size_t gone_ = 0, not_replaced_ = 0, other_builds_ = 0;
};

}  // namespace

std::vector<std::string> keep_earlier(ResultFile& result, ResultFile before, const Plan& plan,
                                      std::vector<std::size_t>& places) {
    return Keeper(result, plan, places).keep(std::move(before));
}

}  // namespace hausbench
