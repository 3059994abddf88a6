// `hausbench export MODEL FILE`: writes a model, or any mesh file, in a format for other programs.
#pragma once

#include "catalogue.h"

#include <filesystem>
#include <string>

namespace hausbench {

// `model` is a name of the catalogue, else a file. `to` is OFF, OBJ or PLY by its extension, with 17 digits: reading it gives
// the same bits. Returns a line that describes what was written. Throws InputError if `model` is neither (names the nearest
// model), if it was not fetched, or if a file cannot be read or written.
std::string export_model(const Catalogue& catalogue, const std::string& model, const std::filesystem::path& to);

}  // namespace hausbench
