// Reads the [model.NAME] tables of the manifest or of an experiment.
#pragma once

#include "datasets/catalogue.h"

#include "datasets/toml_reader.h"

#include <toml++/toml.h>

#include <optional>
#include <string>

namespace hausbench {

// The kind of file that contains the tables. In an experiment `source` may be left out (`path`:
// file; `from`: derived; else generated), and nothing is fetched.
enum class ModelsOf { manifest, experiment };

// Reads one table in the file of `in`, with the same filling. A model may list its coordinates,
// `vertices` and `triangles` or `points`, instead of a recipe. If `from` is given, the model is
// derived from that model, and its table must not say so.
ModelInfo read_model(const TomlReader& in, const std::string& name, const toml::table& table, ModelsOf of,
                     const std::string& from = "");

// Reads all tables [GROUP.NAME] of a file; relative paths start from its folder. Throws
// InputError with file, line and model for an unknown key or value (names the nearest).
std::vector<ModelInfo> read_models(const TomlReader& root, ModelsOf of, const std::string& group = "model");

}  // namespace hausbench
