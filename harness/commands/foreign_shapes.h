// Makes the shapes of a result that somebody else may have written.
#pragma once

#include "datasets/catalogue.h"
#include "harness/result/result_file.h"

#include <map>
#include <string>
#include <vector>

namespace hausbench {

// Returns the shapes of the result's models by name, and adds a line to `missing` for each model that is not here. The result says
// how they are made, so a process of its own makes them, within limits of time, memory and size, and writes nothing to the cache.
// Throws InputError beyond a limit, for a model that cannot be made, and for one that differs from what was measured.
std::map<std::string, Shape> foreign_shapes(const ResultFile& result, const Catalogue& manifest,
                                            std::vector<std::string>& missing);

}  // namespace hausbench
