// Paths of the project, found from the working directory or the program; environment variables override them.
#pragma once

#include <filesystem>
#include <optional>

namespace hausbench {

// The file of this program.
std::filesystem::path program_path();

// The checkout, or a folder of one's own that is made like it: HAUSBENCH_ROOT, else the nearest folder above the working
// directory, else above the program, that holds datasets/manifest.toml. None: an installed program far from any. Throws
// InputError if HAUSBENCH_ROOT holds none, and if another user can write to the nearest one.
std::optional<std::filesystem::path> find_project_root();
std::filesystem::path project_root();  // throws InputError if there is none

// share/hausbench beside the folder of the program, whether or not it exists.
std::filesystem::path installed_folder();

// Returns the manifest of the project, otherwise the one that was installed with the program; empty if there is
// neither, and then no model has a name.
std::filesystem::path manifest_file();

// Likewise, whether or not it exists.
std::filesystem::path experiments_folder();

// `results` of HAUSBENCH_ROOT, else of the checkout that has the experiment's file, else of the current folder.
std::filesystem::path results_folder(const std::filesystem::path& experiment);

// HAUSBENCH_CACHE, else datasets/cache of the project, else hausbench in the user's folder for caches: fetched files and shapes.
std::filesystem::path cache_folder();

}  // namespace hausbench
