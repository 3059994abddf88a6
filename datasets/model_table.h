// Reads the [model.NAME] tables of the manifest or of an experiment.
#pragma once

#include "datasets/catalogue.h"

#include "datasets/toml_reader.h"

#include <toml++/toml.h>

#include <optional>
#include <string>

namespace hausbench {

// The kind of file that contains the tables. In an experiment, `source` may be left out: it is then "file" if the table
// has `path`, "derived" if it has `from`, and "generated" otherwise. Models of packages, which must be fetched, are
// only allowed in the manifest.
enum class ModelsOf { manifest, experiment };

// Reads the table of one model, in the file of `in` and with the same replacement for {} (TomlReader::fill). Instead of
// a recipe, a table may list coordinates: `vertices` and `triangles`, or `points`. If `from` is not empty, the model is
// derived from the model of that name, and its table must not have the keys `source` and `from`. Throws InputError.
ModelInfo read_model(const TomlReader& in, const std::string& name, const toml::table& table, ModelsOf of,
                     const std::string& from = "");

// Reads all tables [GROUP.NAME] of a file. Relative paths in them start from the folder of the file. Throws InputError
// for an unknown key or value; the message has the file, the line, the model and the nearest known key or value.
std::vector<ModelInfo> read_models(const TomlReader& root, ModelsOf of, const std::string& group = "model");

}  // namespace hausbench
