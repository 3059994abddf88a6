#include "harness/plan/references.h"

#include "algorithms/registry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <tuple>

namespace hausbench {

namespace {

constexpr double finer = 0.01;  // tolerance of a reference answer / finest tolerance on its scene

// Returns the name of the solver that computes reference answers for shapes of these kinds. Returns an empty string if
// there is none, or if it is not built.
std::string solver_for(ShapeKind source, ShapeKind target) {
    const bool surfaces = source == ShapeKind::surface && target == ShapeKind::surface;
    if (!surfaces && (source == ShapeKind::surface || target == ShapeKind::surface)) return "";
    const bool points = source == ShapeKind::points && target == ShapeKind::points;
    const std::string name = surfaces ? "surface_enclosure" : points ? "scan" : "cover";
    const auto& all = solvers();
    const bool built =
        std::any_of(all.begin(), all.end(), [&](const SolverEntry& entry) { return entry.info.name == name; });
    return built ? name : "";
}

SolverPlan plan_of(const std::string& name, Quantity quantity, std::vector<std::string> scenes) {
    SolverPlan solver;
    solver.name = name;
    solver.label = "reference";
    solver.options = {ParameterMap{}};
    solver.quantity = quantity;
    solver.scenes = std::move(scenes);
    return solver;
}

}  // namespace

std::optional<Experiment> references_of(const Plan& plan) {
    Experiment references = plan.experiment;
    references.solvers.clear();
    if (!references.reference) return std::nullopt;
    std::map<std::string, ShapeKind> kinds;
    for (const ModelRow& model : plan.models) kinds[model.info->name] = model.resolved.kind;
    std::map<std::string, double> finest;                                      // by scene
    std::map<std::pair<std::string, Quantity>, std::set<std::string>> scenes;  // by solver and quantity
    std::set<std::string> searches;
    for (const ScenePlan& scene : references.scenes)
        if (scene.search) searches.insert(scene.name);
    for (const Case& spec : plan.cases) {
        const auto source = kinds.find(spec.source), target = kinds.find(spec.target);
        if (source == kinds.end() || target == kinds.end()) continue;  // a model is missing
        if (spec.quantity == Quantity::penetration || spec.quantity == Quantity::distribution ||
            searches.contains(spec.scene))
            continue;
        const std::string solver = solver_for(source->second, target->second);
        if (solver.empty()) continue;
        scenes[{solver, spec.quantity}].insert(spec.scene);
        const auto [at, fresh] = finest.emplace(spec.scene, spec.tolerance);
        at->second = std::min(at->second, spec.tolerance);
    }
    if (scenes.empty()) return std::nullopt;
    for (auto& [key, names] : scenes)
        references.solvers.push_back(plan_of(key.first, key.second, {names.begin(), names.end()}));
    std::erase_if(references.scenes, [&](const ScenePlan& scene) { return !finest.contains(scene.name); });
    for (ScenePlan& scene : references.scenes) {
        const double tolerance = finer * finest.at(scene.name);
        scene.tolerances = {tolerance > 0 ? tolerance : finest.at(scene.name)};
    }
    references.floor = 0;
    references.cutoff = std::numeric_limits<double>::infinity();
    references.budget = -1;
    references.repeats = 0;
    references.rounds = 1;
    references.trace = references.fields = references.stages = false;
    references.limits.case_seconds = references.reference_seconds;
    references.expected_unsound.clear();
    return references;
}

}  // namespace hausbench
