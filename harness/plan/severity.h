// Makes sweeps from harmless to absurd cases: one scene for each value of `severity`, with the value in place of every
// {}. Also reads shapes that a scene describes instead of naming a model.
#pragma once

#include "datasets/catalogue.h"
#include "harness/plan/experiment_table.h"

#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

// Returns one copy of the table for each value in the list `severity`, with the value in place of every {}. If
// `severity` is not a list, returns only the table itself. Throws InputError if the list is empty, has a value twice or
// is combined with another key that makes several scenes, or if the scene's name has no {}.
std::vector<ExperimentTable> by_severity(const ExperimentTable& scene);

// Returns the severity of a scene, given as a number or as one value of a list. Returns NaN if the scene has none.
double severity_of(const ExperimentTable& scene);

// Returns the name of the sweep that a scene belongs to: the key `family` or, by default, the scene's name without {},
// such as "offset" for "offset {}". Returns an empty string if the scene has neither the key nor a list of severities.
std::string family_of(const ExperimentTable& scene);

// Returns the name of the model for `key`, which is "source" or "target". If the scene describes a shape there, the
// name is made from the name of the scene.
std::string model_name(const ExperimentTable& scene, std::string_view key);

// Returns the shapes that a scene describes instead of naming a model. `source` and `target` may each be a table like
// [model.NAME], or a list of such tables in which each shape is derived from the one before it.
std::vector<ModelInfo> models_in(const ExperimentTable& scene);

}  // namespace hausbench
