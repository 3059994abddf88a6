// Reads a [[solver]] table.
#pragma once

#include "harness/plan/experiment.h"
#include "harness/plan/experiment_table.h"

#include <vector>

namespace hausbench {

Quantity read_quantity(const ExperimentTable& table, Quantity otherwise);

// Reads a solver. A parameter with a list of values is swept: the result has every combination of values, each checked
// against the solver's declarations. A solver that is not built gets one empty combination, because its parameters are
// unknown; its cases become `not_built`.
SolverPlan read_solver(const ExperimentTable& table, const Experiment& experiment);

// Throws InputError if the solver lists a single pair of a search in `scenes`, because the pairs of a search make sense
// only together, or if it is warm and runs on a search, whose cases are always cold.
void expect_searches(const ExperimentTable& table, const SolverPlan& solver, const std::vector<ScenePlan>& scenes);

}  // namespace hausbench
