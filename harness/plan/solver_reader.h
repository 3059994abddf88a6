// Reads a [[solver]] table.
#pragma once

#include "harness/plan/experiment.h"
#include "harness/plan/experiment_table.h"

#include <vector>

namespace hausbench {

Quantity read_quantity(const ExperimentTable& table, Quantity otherwise);
std::vector<Statistic> read_statistics(const ExperimentTable& table, const std::vector<Statistic>& otherwise);
WeighBy read_weigh(const ExperimentTable& table, WeighBy otherwise);

// Reads a [[solver]] table. Parameters with lists of values give every combination of these values, each checked
// against the parameters that the solver declares. A solver that is not built gets one empty combination, because its
// parameters are unknown.
SolverPlan read_solver(const ExperimentTable& table, const Experiment& experiment);

// Throws InputError if the solver cannot run on searches as requested. `scenes` must not list a single pair of a
// search, because its pairs make sense only together. A warm solver cannot run on a search, whose cases are always
// cold.
void expect_searches(const ExperimentTable& table, const SolverPlan& solver, const std::vector<ScenePlan>& scenes);

}  // namespace hausbench
