// [model.NAME] tables, of the manifest or of an experiment.
#pragma once

#include "catalogue.h"

#include <toml++/toml.h>

namespace hausbench {

// Where the tables stand. In an experiment `source` may be left out (`path`: file, `from`: derived, else generated), and nothing is
// fetched.
enum class ModelsOf { manifest, experiment };

// All tables of `root`, a file that has been parsed; relative paths count from the file's folder. Throws InputError with file, line and
// model for an unknown key or value (names the nearest).
std::vector<ModelInfo> read_models(const std::filesystem::path& file, const toml::table& root, ModelsOf of);

}  // namespace hausbench
