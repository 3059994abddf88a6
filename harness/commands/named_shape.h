// Reads shapes that are named on a command line.
#pragma once

#include "datasets/load.h"

#include <filesystem>
#include <string>

namespace hausbench {

// Reads a mesh file, or a model of the project by its name, such as bunny. A name with a '/' or an extension is a
// file. Throws InputError for a model that was not fetched, and for a name that is neither.
LoadedShape load_named(const std::string& name);

// Returns the file that load_named() reads for this name; for a derived model, the file of the model that it is derived
// from. Empty if there is none, as for a generated model.
std::filesystem::path file_behind(const std::string& name);

}  // namespace hausbench
