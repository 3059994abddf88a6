// Reads shapes named on the command line.
#pragma once

#include "datasets/load.h"

#include <filesystem>
#include <string>

namespace hausbench {

// Reads a mesh file, or a model of the project by its name, such as "bunny". A name with a '/' or an extension always
// means a file. Throws InputError for a model that was not fetched, and for an unknown name.
LoadedShape load_named(const std::string& name);

// Returns the file that load_named() reads for this name. For a derived model, returns the file of the model from which
// it is derived. Returns an empty path if the model has no file, such as a generated model.
std::filesystem::path file_behind(const std::string& name);

}  // namespace hausbench
