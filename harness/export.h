// `hausbench export MODEL FILE`: a model, or any mesh file, as other programs read it.
#pragma once

#include "catalogue.h"

#include <filesystem>
#include <string>

namespace hausbench {

// `model` is a name of the catalogue, else a file. `to` is OFF, OBJ or PLY by its extension, with 17 digits: reading it gives
// the same bits. Returns a line that says what was written. Throws InputError for neither (names the nearest model), a model
// that was not fetched, a file that cannot be read or written.
std::string export_model(const Catalogue& catalogue, const std::string& model, const std::filesystem::path& to);

}  // namespace hausbench
