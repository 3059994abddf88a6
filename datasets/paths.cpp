#include "paths.h"

#include "error.h"

#include <fmt/format.h>

#include <cstdlib>

namespace hausbench {

namespace fs = std::filesystem;

fs::path program_path() { return fs::read_symlink("/proc/self/exe"); }

std::optional<fs::path> find_project_root() {
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
    return std::nullopt;
}

fs::path project_root() {
    if (const auto root = find_project_root()) return *root;
    throw InputError(
        "no datasets/manifest.toml above the working directory or the program: run inside the checkout, or set "
        "HAUSBENCH_ROOT to it");
}

fs::path manifest_file() {
    if (const auto root = find_project_root()) return *root / "datasets" / "manifest.toml";
    const fs::path installed =
        program_path().parent_path().parent_path() / "share" / "hausbench" / "datasets" / "manifest.toml";
    return fs::exists(installed) ? installed : fs::path();
}

fs::path results_folder() {
    const auto root = find_project_root();
    return root ? *root / "results" : fs::path("results");
}

fs::path cache_folder() {
    if (const char* cache = std::getenv("HAUSBENCH_CACHE")) return cache;
    if (const auto root = find_project_root()) return *root / "datasets" / "cache";
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && fs::path(cache).is_absolute())
        return fs::path(cache) / "hausbench";
    if (const char* home = std::getenv("HOME"); home && fs::path(home).is_absolute())
        return fs::path(home) / ".cache" / "hausbench";
    throw InputError("there is no folder for models that are read or made: set HAUSBENCH_CACHE to one");
}

}  // namespace hausbench
