// Paths of the project, found from the working directory or the program; environment variables override them.
#pragma once

#include <filesystem>

namespace hausbench {

// The file of this program.
std::filesystem::path program_path();

// The checkout: HAUSBENCH_ROOT, else the nearest folder above the working directory, else above the program, that holds
// datasets/manifest.toml. Throws InputError if there is none, or HAUSBENCH_ROOT holds none.
std::filesystem::path project_root();

// HAUSBENCH_CACHE, else datasets/cache of the project: fetched files and shapes.
std::filesystem::path cache_folder();

}  // namespace hausbench
