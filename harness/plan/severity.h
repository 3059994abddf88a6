// Sweeps of cases from harmless to absurd: one scene for each value of `severity`, with that value in place of every
// {}. Also reads shapes that a scene describes in place of a model's name.
#pragma once

#include "datasets/catalogue.h"
#include "harness/plan/experiment_table.h"

#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

// If `severity` is a list, returns one copy of the table for each value, with the value in place of every {}. Otherwise
// returns the table itself. Throws InputError for a list that is empty, has a value twice or is combined with other
// keys that make several scenes, and if the name of the scene has no {}.
std::vector<ExperimentTable> by_severity(const ExperimentTable& scene);

// Returns the severity of a scene: its value in a list of severities, or the number in the table; NaN if there is none.
double severity_of(const ExperimentTable& scene);

// Returns the name of the sweep to which a scene belongs: the key `family` or, if that is missing, the scene's name
// without {}, such as "offset" for "offset {}". Returns an empty string if the scene has no list of severities either.
std::string family_of(const ExperimentTable& scene);

// Returns the name of the model that `key` ("source" or "target") stands for: the name written there, or the name of
// the shape described there.
std::string model_name(const ExperimentTable& scene, std::string_view key);

// Returns the shapes that the scene describes instead of naming a model. `source` and `target` may each be a table like
// [model.NAME], or a list of such tables, in which each shape but the first is derived from the one before it.
std::vector<ModelInfo> models_in(const ExperimentTable& scene);

}  // namespace hausbench
