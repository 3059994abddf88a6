// Reads a [[solver]] table.
#pragma once

#include "harness/plan/experiment.h"
#include "harness/plan/experiment_table.h"

#include <vector>

namespace hausbench {

Quantity read_quantity(const ExperimentTable& table, Quantity otherwise);

// With every combination of the parameters that it sweeps, each checked against the solver's declarations. A solver that is not built
// keeps none: its parameters are unknown, and its cases become `not_built`.
SolverPlan read_solver(const ExperimentTable& table, const Experiment& experiment);

// The pairs of a search make sense together only, and each is a cold case.
void expect_searches(const ExperimentTable& table, const SolverPlan& solver, const std::vector<ScenePlan>& scenes);

}  // namespace hausbench
