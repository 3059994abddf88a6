// The parts of a case that do not depend on pose and tolerance.
#pragma once

#include "harness/plan/experiment.h"
#include "harness/plan/scene_models.h"

#include <string>
#include <vector>

namespace hausbench {

// Returns the properties that all cases of a solver on a scene share. `entry` is null if the solver is not built.
Case common_case(const Experiment& experiment, const ScenePlan& scene, const SceneModels& models,
                 const SolverPlan& solver, const SolverEntry* entry, const ParameterMap& given);

// Returns the statistics of a solver, as texts; a single empty text for a quantity other than `distribution`.
std::vector<std::string> statistics_of(const SolverPlan& solver);

}  // namespace hausbench
