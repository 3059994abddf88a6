// Reads a [[solver]] table.
#pragma once

#include "harness/plan/experiment.h"
#include "harness/plan/experiment_table.h"

#include <vector>

namespace hausbench {

Quantity read_quantity(const ExperimentTable& table, Quantity otherwise);

// Reads a solver with every combination of the parameters that it sweeps, each checked against the solver's
// declarations. A solver that is not built gets one empty combination: its parameters are unknown, and its cases
// become `not_built`.
SolverPlan read_solver(const ExperimentTable& table, const Experiment& experiment);

// Throws InputError if the solver names a single pair of a search, since its pairs make sense only together, or is
// warm on a search, whose cases are cold.
void expect_searches(const ExperimentTable& table, const SolverPlan& solver, const std::vector<ScenePlan>& scenes);

}  // namespace hausbench
