// [model.NAME] tables, of the manifest or of an experiment.
#pragma once

#include "datasets/catalogue.h"

#include "datasets/toml_reader.h"

#include <toml++/toml.h>

#include <optional>
#include <string>

namespace hausbench {

// The file of the tables. In an experiment `source` may be left out (`path` means file, `from` derived, otherwise
// generated), and nothing is fetched.
enum class ModelsOf { manifest, experiment };

// One table, which stands in the file of `in` and is filled as that one is. A model may list its coordinates, `vertices` and `triangles`
// or `points`, in place of a recipe. With `from` it is derived from that model, and its table must not say so.
ModelInfo read_model(const TomlReader& in, const std::string& name, const toml::table& table, ModelsOf of,
                     const std::string& from = "");

// All tables [GROUP.NAME] of a file; relative paths count from its folder. Throws InputError with file, line and model for an unknown key
// or value (names the nearest).
std::vector<ModelInfo> read_models(const TomlReader& root, ModelsOf of, const std::string& group = "model");

}  // namespace hausbench
