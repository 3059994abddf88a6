// Cases that are swept from harmless to absurd: one scene for each value of `severity`, with that value in place of every {}; and shapes that
// a scene describes in place, where a model's name would stand.
#pragma once

#include "datasets/catalogue.h"
#include "harness/plan/experiment_table.h"

#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

// A reader of the scene for each value of its `severity`, where that is a list; else the one that it is. Throws InputError for a list
// that is empty or repeats itself, beside other keys that expand a scene, or without {} in the scene's name.
std::vector<ExperimentTable> by_severity(const ExperimentTable& scene);

// Of `severity`: NaN where there is none.
double severity_of(const ExperimentTable& scene);

// The key `family`, else the name of a scene with a list of severities, without its {}; else empty.
std::string family_of(const ExperimentTable& scene);

// The name of the model that `key`, which is "source" or "target", stands for: the one that is written there, or the name of a shape that
// is described there.
std::string model_name(const ExperimentTable& scene, std::string_view key);

// The shapes that the scene describes in place: a table as [model.NAME] has, or a list of them, in which each but the first is derived from
// the one before it.
std::vector<ModelInfo> models_in(const ExperimentTable& scene);

}  // namespace hausbench
