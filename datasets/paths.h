// Paths of the project, found from the working directory or from the location of the program; environment variables
// override them.
#pragma once

#include <filesystem>
#include <optional>

namespace hausbench {

// Returns the path of this program.
std::filesystem::path program_path();

// Returns the root of the project: the checkout, or your own folder with the same layout. This is HAUSBENCH_ROOT if it
// is set; otherwise the working directory or the nearest folder above it that contains datasets/manifest.toml;
// otherwise the nearest such folder above the program. Returns nothing if there is none, as for an installed program
// outside of a project. Throws InputError if HAUSBENCH_ROOT has no datasets/manifest.toml, or if another user can write
// to the folder or the manifest that was found: this user could otherwise choose the files that the program reads.
std::optional<std::filesystem::path> find_project_root();
std::filesystem::path project_root();  // throws InputError if there is none

// Returns PREFIX/share/hausbench for the program PREFIX/bin/hausbench, whether or not this folder exists.
std::filesystem::path installed_folder();

// Returns the manifest of the project or, outside of a project, the manifest installed with the program. Returns an
// empty path if there is neither; then no models are known by name.
std::filesystem::path manifest_file();

// Returns the folder `experiments` of the project or, outside of a project, of the installation, whether or not it
// exists.
std::filesystem::path experiments_folder();

// Returns the folder for the results of an experiment, which is given by its file: `results` in HAUSBENCH_ROOT if it is
// set, otherwise in the project that contains the file, otherwise in the working directory.
std::filesystem::path results_folder(const std::filesystem::path& experiment);

// Returns the folder for fetched files and prepared shapes: HAUSBENCH_CACHE if it is set, otherwise datasets/cache of
// the project, otherwise `hausbench` in the user's cache folder ($XDG_CACHE_HOME or ~/.cache).
std::filesystem::path cache_folder();

}  // namespace hausbench
