#include "harness/plan/common_case.h"

#include "harness/plan/plugin_code.h"

#include <cmath>

namespace hausbench {

Case common_case(const Experiment& experiment, const ScenePlan& scene, const SceneModels& models,
                 const SolverPlan& solver, const SolverEntry* entry, const ParameterMap& given) {
    Case asked;
    asked.solver = solver.name;
    asked.label = solver.label;
    asked.variant = variant_of(given, solver.options);
    asked.profile = experiment.profile;
    asked.options = entry ? Options(solver.name, entry->info.parameters, given).values() : given;
    asked.scene = scene.name;
    asked.note = scene.note;
    asked.family = scene.family;
    asked.severity = scene.severity;
    asked.quantity = solver.quantity;
    asked.weigh = solver.quantity == Quantity::distribution ? solver.weigh : WeighBy::area;
    const bool same =
        solver.quantity == experiment.quantity && solver.statistics.size() <= 1 &&
        (solver.statistics.empty() || (solver.statistics == experiment.statistics && solver.weigh == experiment.weigh));
    const bool largest = experiment.quantity == Quantity::directed && solver.quantity == Quantity::distribution &&
                         solver.statistics == std::vector<Statistic>{{Statistic::Kind::maximum}} &&
                         solver.weigh == WeighBy::area;  // this is h(A,B)
    if (same || largest) asked.exact = scene.exact;
    asked.source = scene.source;
    asked.target = scene.target;
    if (const auto* source = std::get_if<ResolvedModel>(&models.source)) {
        asked.source_hash = source->content_hash;
        asked.source_elements = source->elements;
        asked.source_diagonal = source->diagonal;
        asked.source_longest = source->longest_side;
    }
    if (const auto* target = std::get_if<ResolvedModel>(&models.target)) {
        asked.target_hash = target->content_hash;
        asked.target_elements = target->elements;
    }
    asked.tolerance_of = experiment.of;
    asked.limits = experiment.limits;
    asked.floor = experiment.floor * asked.unit();
    asked.cutoff = std::isinf(experiment.cutoff) ? experiment.cutoff : experiment.cutoff * asked.unit();
    asked.budget = experiment.budget;
    asked.threads = entry && entry->info.can(Ability::threads) ? solver.threads : 1;
    asked.warm = solver.warm;
    asked.certified = entry ? promises(*entry, given) : -1;
    return asked;
}

std::vector<std::string> statistics_of(const SolverPlan& solver) {
    std::vector<std::string> all;
    for (const Statistic& one : solver.statistics) all.push_back(to_string(one));
    return all.empty() ? std::vector<std::string>{""} : all;
}

}  // namespace hausbench
