// Shapes that a command line names.
#pragma once

#include "load.h"

#include <string>

namespace hausbench {

// Reads a mesh file, or a model of the project by its name, such as bunny. A text with a '/' or an extension is a file. Throws
// InputError for a model that was not fetched, and for a text that is neither.
LoadedShape load_named(const std::string& name);

}  // namespace hausbench
