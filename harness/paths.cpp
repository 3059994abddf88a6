#include "paths.h"

#include "error.h"

#include <fmt/format.h>

#include <cstdlib>

namespace hausbench {

namespace fs = std::filesystem;

fs::path program_path() { return fs::read_symlink("/proc/self/exe"); }

fs::path project_root() {
    if (const char* root = std::getenv("HAUSBENCH_ROOT")) {
        std::error_code ignored;
        if (fs::exists(fs::path(root) / "datasets" / "manifest.toml", ignored)) return root;
        throw InputError(
            fmt::format("HAUSBENCH_ROOT={}: no datasets/manifest.toml in it: set it to the checkout", root));
    }
    for (const fs::path& start : {fs::current_path(), program_path().parent_path()}) {
        for (fs::path folder = start; folder.has_relative_path(); folder = folder.parent_path()) {
            if (fs::exists(folder / "datasets" / "manifest.toml")) return folder;
        }
    }
    throw InputError(
        "no datasets/manifest.toml above the working directory or the program: run inside the checkout, or set "
        "HAUSBENCH_ROOT to it");
}

fs::path cache_folder() {
    if (const char* cache = std::getenv("HAUSBENCH_CACHE")) return cache;
    return project_root() / "datasets" / "cache";
}

}  // namespace hausbench
