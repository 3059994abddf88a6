// Shapes that a command line names.
#pragma once

#include "datasets/load.h"

#include <filesystem>
#include <string>

namespace hausbench {

// Reads a mesh file, or a model of the project by its name, such as bunny. A text with a '/' or an extension is a file. Throws
// InputError for a model that was not fetched, and for a text that is neither.
LoadedShape load_named(const std::string& name);

// The file that load_named() reads for this name, or from which the model is derived; empty: there is none, as of a generated model.
std::filesystem::path file_behind(const std::string& name);

}  // namespace hausbench
