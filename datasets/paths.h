// Paths of the project, found from the working directory or from the program; environment variables override them.
#pragma once

#include <filesystem>
#include <optional>

namespace hausbench {

// Returns the path of this program.
std::filesystem::path program_path();

// Returns the checkout, or your own folder with the same layout: HAUSBENCH_ROOT, else the nearest
// folder above the working directory, else above the program, that contains
// datasets/manifest.toml. Returns nothing for an installed program far from any. Throws InputError
// if HAUSBENCH_ROOT does not contain one, or if another user can write to the nearest one.
std::optional<std::filesystem::path> find_project_root();
std::filesystem::path project_root();  // throws InputError if there is none

// Returns share/hausbench beside the folder of the program, whether or not it exists.
std::filesystem::path installed_folder();

// Returns the manifest of the project, else the manifest installed with the program; empty if
// there is neither, and then no model has a name.
std::filesystem::path manifest_file();

// Returns the experiments folder likewise, whether or not it exists.
std::filesystem::path experiments_folder();

// Returns `results` in HAUSBENCH_ROOT, else in the checkout that contains the experiment's file,
// else in the current folder.
std::filesystem::path results_folder(const std::filesystem::path& experiment);

// Returns the folder for fetched files and shapes: HAUSBENCH_CACHE, else datasets/cache of the
// project, else hausbench in the user's cache folder.
std::filesystem::path cache_folder();

}  // namespace hausbench
