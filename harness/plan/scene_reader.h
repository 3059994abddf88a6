// Reads a [[scene]] table, and expands it into one scene for each pair of models.
#pragma once

#include "harness/plan/experiment.h"
#include "harness/plan/experiment_table.h"

#include <vector>

namespace hausbench {

ScenePlan read_scene(const ExperimentTable& table);

// One scene for each source and each target, source by source, for each model, or for each pair of a recording; else the one that it is.
std::vector<ScenePlan> expand(const ExperimentTable& table, const ScenePlan& scene);

// A file of poses that cannot be read is an error of the experiment: it is found before anything runs.
void expect_pose_files(const ExperimentTable& table, const ScenePlan& scene);

}  // namespace hausbench
