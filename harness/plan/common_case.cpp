#include "harness/plan/common_case.h"

#include "harness/plan/plugin_code.h"

#include <cmath>

namespace hausbench {

Case common_case(const Experiment& experiment, const ScenePlan& scene, const SceneModels& models,
                 const SolverPlan& solver, const SolverEntry* entry, const ParameterMap& given) {
    Case spec;
    spec.solver = solver.name;
    spec.label = solver.label;
    spec.variant = variant_of(given, solver.options);
    spec.profile = experiment.profile;
    spec.options = entry ? Options(solver.name, entry->info.parameters, given).values() : given;
    spec.scene = scene.name;
    spec.note = scene.note;
    spec.family = scene.family;
    spec.severity = scene.severity;
    spec.quantity = solver.quantity;
    spec.weigh = solver.quantity == Quantity::distribution ? solver.weigh : WeighBy::area;
    const bool same =
        solver.quantity == experiment.quantity && solver.statistics.size() <= 1 &&
        (solver.statistics.empty() || (solver.statistics == experiment.statistics && solver.weigh == experiment.weigh));
    const bool largest = experiment.quantity == Quantity::directed && solver.quantity == Quantity::distribution &&
                         solver.statistics == std::vector<Statistic>{{Statistic::Kind::maximum}} &&
                         solver.weigh == WeighBy::area;  // this is h(A,B)
    if (same || largest) spec.exact = scene.exact;
    spec.source = scene.source;
    spec.target = scene.target;
    if (const auto* source = std::get_if<ResolvedModel>(&models.source)) {
        spec.source_hash = source->content_hash;
        spec.source_elements = source->elements;
        spec.source_diagonal = source->diagonal;
        spec.source_longest = source->longest_side;
    }
    if (const auto* target = std::get_if<ResolvedModel>(&models.target)) {
        spec.target_hash = target->content_hash;
        spec.target_elements = target->elements;
    }
    spec.tolerance_of = experiment.of;
    spec.limits = experiment.limits;
    spec.floor = experiment.floor * spec.unit();
    spec.cutoff = std::isinf(experiment.cutoff) ? experiment.cutoff : experiment.cutoff * spec.unit();
    spec.budget = experiment.budget;
    spec.threads = entry && entry->info.can(Ability::threads) ? solver.threads : 1;
    spec.warm = solver.warm;
    spec.certified = entry ? promises(*entry, given) : -1;
    return spec;
}

std::vector<std::string> statistics_of(const SolverPlan& solver) {
    std::vector<std::string> all;
    for (const Statistic& statistic : solver.statistics) all.push_back(to_string(statistic));
    return all.empty() ? std::vector<std::string>{""} : all;
}

}  // namespace hausbench
