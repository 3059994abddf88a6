// Reads a [[scene]] table and expands it into one scene for each pair of models.
#pragma once

#include "harness/plan/experiment.h"
#include "harness/plan/experiment_table.h"

#include <vector>

namespace hausbench {

ScenePlan read_scene(const ExperimentTable& table);

// Returns the scenes that a table describes: one for each pair of a matrix (source by source), for each model in
// `each`, or for each pair of models in a recording. Otherwise returns just `scene`.
std::vector<ScenePlan> expand(const ExperimentTable& table, const ScenePlan& scene);

// Throws InputError if a pose file of the scene cannot be read, so that the error is found before anything runs.
void expect_pose_files(const ExperimentTable& table, const ScenePlan& scene);

}  // namespace hausbench
