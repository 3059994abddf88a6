// Sweeps of cases from harmless to absurd: one scene for each value of `severity`, with that value in place of every
// {}. Also reads shapes that a scene describes in place of a model's name.
#pragma once

#include "datasets/catalogue.h"
#include "harness/plan/experiment_table.h"

#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

// Returns a table of the scene for each value of its `severity` if that is a list, otherwise the table itself. Throws
// InputError for a list that is empty, has a value twice, is combined with other keys that expand a scene, or comes
// with a scene name without {}.
std::vector<ExperimentTable> by_severity(const ExperimentTable& scene);

// Returns the value of `severity`; NaN if there is none.
double severity_of(const ExperimentTable& scene);

// Returns the key `family`; if it is missing, the name of a scene with a list of severities, without its {};
// otherwise an empty string.
std::string family_of(const ExperimentTable& scene);

// Returns the name of the model that `key` ("source" or "target") stands for: the name written there, or the name of
// the shape described there.
std::string model_name(const ExperimentTable& scene, std::string_view key);

// Returns the shapes that the scene describes in place: each is a table like [model.NAME], or a list of tables, in
// which each shape but the first is derived from the one before it.
std::vector<ModelInfo> models_in(const ExperimentTable& scene);

}  // namespace hausbench
