#include "harness/plan/plan.h"

#include "algorithms/error.h"
#include "algorithms/registry.h"
#include "algorithms/session/moving_target.h"
#include "algorithms/session/session.h"
#include "datasets/hash.h"
#include "harness/plan/command_files.h"
#include "harness/plan/common_case.h"
#include "harness/plan/jobs.h"
#include "harness/plan/references.h"
#include "harness/plan/scene_models.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

namespace hausbench {

namespace {

void check_choice(const std::vector<std::string>& chosen, const std::vector<std::string>& names,
                  const std::string& what) {
    for (const std::string& name : chosen) {
        if (std::find(names.begin(), names.end(), name) == names.end()) {
            throw InputError(
                fmt::format("--{}: the experiment has no {} '{}'{}", what, what, name, nearest_hint(name, names)));
        }
    }
}

bool chosen(const std::vector<std::string>& choice, const std::string& name) {
    return choice.empty() || std::find(choice.begin(), choice.end(), name) != choice.end();
}

// Returns the name of the [[scene]] table if it made several scenes. Otherwise returns an empty string.
const std::string& group_of(const ScenePlan& scene) { return scene.each.empty() ? scene.matrix : scene.each; }

// Returns whether `choice` is empty or lists a scene, by its own name or by the name of its [[scene]] table.
bool chosen(const std::vector<std::string>& choice, const ScenePlan& scene) {
    return chosen(choice, scene.name) || (!group_of(scene).empty() && chosen(choice, group_of(scene)));
}

// One solver with given parameters on one scene, and the properties that its cases share.
struct SolverOnScene {
    const ScenePlan& scene;
    const SceneModels& models;
    const SolverPlan& solver;
    const ParameterMap& given;
    const SolverEntry* entry = nullptr;   // null: the solver is not built
    std::optional<Outcome> decided = {};  // the outcome of all cases, if none can run
    std::vector<double> tolerances = {};  // the finest first
    Case common = {};
};

class Planner {
public:
    explicit Planner(const Experiment& experiment) { plan_.experiment = experiment; }

    Plan make(const Choice& choice, const Catalogue& catalogue, ModelFinder& finder) {
        const Experiment& experiment = plan_.experiment;
        std::vector<std::string> scene_names, solver_names;
        for (const ScenePlan& scene : experiment.scenes) {
            scene_names.push_back(scene.name);
            if (!group_of(scene).empty() &&
                std::find(scene_names.begin(), scene_names.end(), group_of(scene)) == scene_names.end())
                scene_names.push_back(group_of(scene));
        }
        for (const SolverPlan& solver : experiment.solvers) solver_names.push_back(solver.label);
        plan_.leave_nothing_out = choice.leave_nothing_out;
        plan_.whole = choice.solvers.empty() && choice.scenes.empty();
        check_choice(choice.scenes, scene_names, "scene");
        check_choice(choice.solvers, solver_names, "solver");
        // Checks all names first, so that a wrong name is reported before any model is derived.
        for (const ScenePlan& scene : experiment.scenes) {
            if (scene.search && !choice.scenes.empty() && chosen(choice.scenes, scene.name))
                throw InputError(fmt::format("--scene: '{}' is a pair of a search: choose the whole of it, '{}'",
                                             scene.name, scene.matrix));
            catalogue.find(scene.source);
            catalogue.find(scene.target);
            if (chosen(choice.scenes, scene)) finder.expect(scene);
        }
        catalogue.make_folders();  // throws if they cannot be made; otherwise every row would fail for lack of models
        for (std::size_t i = 0; i < experiment.scenes.size(); ++i) {
            const ScenePlan& scene = experiment.scenes[i];
            if (!chosen(choice.scenes, scene)) continue;
            const SceneModels models = finder.find(scene);
            for (const SolverPlan& solver : experiment.solvers) {
                if (!chosen(choice.solvers, solver.label) || !chosen(solver.scenes, scene)) continue;
                for (const ParameterMap& options : solver.options)
                    for (const std::string& statistic : statistics_of(solver))
                        add(i, models, solver, options, statistic);
            }
        }
        if (plan_.cases.empty()) refuse_empty();
        plan_.models = finder.rows();
        join_matrices(plan_);
        interleave_seeds(plan_);
        check_identities();
        return std::move(plan_);
    }

    AskedCases as_recorded(const RecordedModels& recorded) {
        AskedCases requested;
        for (const ScenePlan& scene : plan_.experiment.scenes) {
            const SceneModels models = recorded.find(scene);
            if (models.row == RowStatus::failed) requested.unknown.insert(scene.name);
            for (const SolverPlan& solver : plan_.experiment.solvers) {
                if (!chosen(solver.scenes, scene)) continue;
                for (const ParameterMap& options : solver.options)
                    for (const std::string& statistic : statistics_of(solver))
                        add_cases(look_at(scene, models, solver, options, statistic));
            }
        }
        check_identities();
        requested.cases = std::move(plan_.cases);
        return requested;
    }

private:
    void add(std::size_t scene_number, const SceneModels& models, const SolverPlan& solver, const ParameterMap& given,
             const std::string& statistic) {
        const SolverOnScene setup = look_at(plan_.experiment.scenes[scene_number], models, solver, given, statistic);
        const std::string label =
            fmt::format("{} on {}{}", shown(setup.common), setup.scene.name, suffix_of_statistic(setup.common));
        std::size_t run = 0;
        for (Job& job : add_cases(setup)) {
            if (job.cases.empty()) continue;
            run += job.cases.size();
            job.scene = scene_number;
            job.label = label;
            const auto &source = std::get<ResolvedModel>(models.source),
                       &target = std::get<ResolvedModel>(models.target);
            const QuerySet queries = queries_of(setup, job);
            job.pairs.push_back({source.shape_file, target.shape_file, queries, job.cases.size()});
            if (queries.target_copied) note_copies(label, queries, models);
            plan_.jobs.push_back(std::move(job));
        }
        note(label, setup, models.poses.size() * setup.tolerances.size(), run);
    }

    // Collects the properties that the cases of a solver on a scene share. Sets `decided` if no case can run.
    SolverOnScene look_at(const ScenePlan& scene, const SceneModels& models, const SolverPlan& solver,
                          const ParameterMap& given, const std::string& statistic) {
        SolverOnScene setup{scene, models, solver, given};
        const auto decide = [&](RowStatus status, const std::string& reason) {
            if (setup.decided || reason.empty()) return;
            setup.decided.emplace();
            setup.decided->status = status;
            setup.decided->reason = reason;
        };
        for (const NotBuilt& absent : solvers_not_built()) {
            if (absent.name == solver.name) decide(RowStatus::not_built, absent.reason);
        }
        if (!setup.decided) setup.entry = &find_solver(solver.name);
        decide(models.row, models.missing);
        if (!setup.decided)
            decide(RowStatus::skipped, refusal(setup.entry->info, std::get<ResolvedModel>(models.source).kind,
                                               std::get<ResolvedModel>(models.target).kind, solver.quantity));
        // A missing program is treated like a missing model: the rows say why they were skipped, and other solvers run.
        const CommandFiles files = setup.entry ? files_of(*setup.entry, given) : CommandFiles{};
        decide(RowStatus::skipped, files.missing);
        setup.tolerances = setup.scene.tolerances.empty() ? solver.tolerances : setup.scene.tolerances;
        std::sort(setup.tolerances.begin(), setup.tolerances.end());
        setup.common = common_case(plan_.experiment, scene, models, solver, setup.entry, given);
        setup.common.program_sha256 = files.sha256;
        setup.common.statistic = statistic;
        return setup;
    }

    // Adds a case for each pose and tolerance. Returns the jobs that run these cases: one job, or one for each
    // tolerance if the cases form chains (see Job). The caller fills in Job::pairs. A pair that cannot run gets rows
    // but is left out of the chain of its search, so that no answer depends on it.
    std::vector<Job> add_cases(const SolverOnScene& setup) {
        const ScenePlan& scene = setup.scene;
        const std::vector<double>& tolerances = setup.tolerances;
        // Does not read answers off the trace if only the finest tolerance builds structures over a copy of a moved
        // target, because the trace then shows longer times than a coarser tolerance would take.
        const bool reads_trace =
            setup.entry && !scene.search && reads_finer(*setup.entry, setup.solver, setup.given) &&
            (!copies_targets(setup, tolerances.front()) || copies_targets(setup, tolerances.back()));
        const bool chained = setup.solver.warm || (scene.search && !setup.decided);
        std::vector<Job> jobs(chained ? tolerances.size() : 1);
        std::vector<std::string> alone;
        auto& before =
            scene.search ? searches_[{scene.matrix, scene.source, setup.common.statistic, &setup.given}] : alone;
        before.resize(tolerances.size());
        for (std::size_t p = 0; p < setup.models.poses.size(); ++p) {
            std::size_t finest = 0;
            for (std::size_t t = 0; t < tolerances.size(); ++t) {
                Case spec = setup.common;
                spec.pose_index = int(p);
                if (!scene.frames.empty()) spec.frame = scene.frames[p];
                spec.pose = setup.models.poses[p].source;
                spec.target_pose = setup.models.poses[p].target;
                spec.tolerance = tolerances[t];
                if (chained) spec.chain = before[t];
                spec.identity = identify(spec);
                if (chained) before[t] = spec.identity;
                const std::size_t row = plan_.cases.size();
                plan_.cases.push_back(std::move(spec));
                if (setup.decided) {
                    plan_.decided[row] = *setup.decided;
                } else if (t > 0 && reads_trace) {
                    plan_.read_off(row, {finest, ignores_tolerance(setup.entry->info, setup.given)});
                } else {
                    if (t == 0) finest = row;
                    jobs[chained ? t : 0].cases.push_back(row);
                }
            }
        }
        return jobs;
    }

    QuerySet queries_of(const SolverOnScene& setup, const Job& job) const {
        const Case& first = plan_.cases[job.cases.front()];
        const Tolerance tolerance = first.resolved_tolerance();
        QuerySet queries;
        queries.moves = moves(setup.scene.motion);
        queries.target_moves = moves(setup.scene.target_motion);
        queries.symmetric = setup.solver.quantity == Quantity::symmetric;
        queries.both_ways = !first.statistic.empty() && needs_target(statistic_of(first.statistic));
        queries.threads = first.threads;
        queries.count = job.cases.size();
        queries.finest_tolerance = tolerance.of == Tolerance::Of::absolute ? tolerance.value : 0;
        queries.target_copied = copies_targets(setup, first.tolerance);
        return queries;
    }

    // Returns whether the solver runs and builds structures over a moved copy of the target at some pose.
    static bool copies_targets(const SolverOnScene& setup, double tolerance) {
        if (setup.decided) return false;
        const SceneModels& models = setup.models;
        const ShapeKind source = std::get<ResolvedModel>(models.source).kind,
                        target = std::get<ResolvedModel>(models.target).kind;
        Case spec = setup.common;
        spec.tolerance = tolerance;
        Query query;
        query.quantity = spec.quantity;
        query.tolerance = spec.resolved_tolerance();
        query.floor = spec.floor;
        query.cutoff = spec.cutoff;
        return std::any_of(models.poses.begin(), models.poses.end(), [&](const ScenePose& pose) {
            query.source_pose = pose.source;
            query.target_pose = pose.target;
            return hausbench::copies_targets(setup.entry->info, query, {source, models.source_largest},
                                             {target, models.target_largest});
        });
    }

    // Finds and hashes the files named in the command lines among the solver's parameters.
    CommandFiles files_of(const SolverEntry& entry, const ParameterMap& given) {
        CommandFiles all;
        for (const ParameterSpec& spec : entry.info.parameters) {
            if (!spec.command) continue;
            const auto value = given.find(spec.name);
            const std::string line = std::get<std::string>(value == given.end() ? spec.default_value : value->second);
            const auto at = commands_.find(line);
            const CommandFiles files =
                at != commands_.end() ? at->second : files_of_command(line, plan_.experiment.folder());
            commands_[line] = files;
            all.sha256 = all.sha256.empty() ? files.sha256 : Sha256().add(all.sha256).add(files.sha256).hex();
            if (all.missing.empty()) all.missing = files.missing;
        }
        return all;
    }

    // Returns whether answers to coarser tolerances can be read off the run of the finest one. Warm cases must be run,
    // because they depend on the answers before them.
    bool reads_finer(const SolverEntry& entry, const SolverPlan& solver, const ParameterMap& options) const {
        const Experiment& e = plan_.experiment;
        const bool traced = e.trace && entry.info.can(Ability::traces) && entry.info.can(Ability::coarser_answers) &&
                            e.of != "lower" && solver.quantity == Quantity::directed;  // H has no trace of its own
        return (ignores_tolerance(entry.info, options) || traced) && !solver.warm && !plan_.leave_nothing_out &&
               e.floor == 0 && std::isinf(e.cutoff) && e.budget < 0;
    }

    void note(const std::string& label, const SolverOnScene& setup, std::size_t requested, std::size_t run) {
        auto& ledger = plan_.ledger;
        if (setup.decided) {
            ledger.push_back({setup.decided->status == RowStatus::not_built ? "not_built" : "not_run", label,
                              "all cases", setup.decided->reason, std::int64_t(requested)});
        } else if (requested > run) {
            ledger.push_back({"not_run", label, coarser_tolerances,
                              ignores_tolerance(setup.entry->info, setup.given)
                                  ? "the solver ignores the tolerance: its answer is the same for each"
                                  : "the trace of the finest tolerance holds their answers",
                              std::int64_t(requested - run)});
        }
    }

    // Records in the ledger that each pose builds structures anew, because the solver does not support moving targets.
    void note_copies(const std::string& label, const QuerySet& queries, const SceneModels& models) {
        const bool both = queries.target_moves && queries.symmetric && queries.moves;
        plan_.ledger.push_back(
            {"prepared_again", label, structures_for_each_pose,
             fmt::format(
                 "the solver offers no moving target: each pose builds what it needs over {} as posed, within its time",
                 both                   ? "A and B"
                 : queries.target_moves ? "B"
                                        : "A"),
             std::int64_t(models.poses.size())});
    }

    [[noreturn]] void refuse_empty() const {
        const Experiment& e = plan_.experiment;
        const char* what = e.scenes.empty() ? "no [[scene]]" : e.solvers.empty() ? "no [[solver]]" : "no case";
        throw InputError(
            fmt::format("{}: {} is left in profile '{}': see what 'profiles' and 'scenes' in it ask for, or choose "
                        "others with --profile, --solver and --scene",
                        e.file.string(), what, e.profile));
    }

    void check_identities() const {
        std::map<std::string, const Case*> seen;
        for (const Case& spec : plan_.cases) {
            const auto [at, fresh] = seen.emplace(spec.identity, &spec);
            if (!fresh && at->second->scene == spec.scene) {
                throw InputError(fmt::format(
                    "{}: '{}' and '{}' ask for the same case on scene '{}{}' (pose {}, tolerance {}): remove one",
                    plan_.experiment.file.string(), shown(*at->second), shown(spec), spec.scene,
                    suffix_of_statistic(spec), spec.pose_index, spec.tolerance));
            }
        }
    }

    std::map<std::string, CommandFiles> commands_;  // by command line
    // Identity of the last case so far in the chain of each tolerance, for each search, source and set of options.
    std::map<std::tuple<std::string, std::string, std::string, const ParameterMap*>, std::vector<std::string>>
        searches_;
    Plan plan_;
};

}  // namespace

std::vector<double> Plan::marks(std::size_t row) const {
    std::vector<double> gaps;
    for (const std::size_t coarse : readers_.of(row)) gaps.push_back(cases[coarse].resolved_tolerance().value);
    std::sort(gaps.rbegin(), gaps.rend());
    return gaps;
}

void Plan::read_off(std::size_t row, const FromTrace& from) {
    traced[row] = from;
    if (!from.ignores_tolerance) readers_.add(from.of, row);
}

Plan make_plan(const Experiment& experiment, const Catalogue& catalogue, const Choice& choice, const SayModel& say) {
    ModelFinder finder(catalogue, say);
    Plan plan = Planner(experiment).make(choice, catalogue, finder);
    if (const auto references = references_of(plan))
        plan.references = std::make_shared<Plan>(Planner(*references).make({}, catalogue, finder));
    return plan;
}

AskedCases cases_as_recorded(const Experiment& experiment, const std::vector<ModelRecord>& models,
                             const ShapeOf& shape_of) {
    return Planner(experiment).as_recorded(RecordedModels(models, shape_of));
}

}  // namespace hausbench
