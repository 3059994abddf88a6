#include "datasets/paths.h"

#include "algorithms/error.h"

#include <fmt/format.h>

#include <grp.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

// Returns whether a file or folder belongs to this user, to root or to the owner of the program, and no other user may
// write to it. Write permission for a group is accepted only for root's group and for the owner's personal group, which
// `adduser` creates with the name of the user.
bool is_ours(const fs::path& place) {
    struct stat state {
    }, program{};
    if (::stat(place.c_str(), &state) != 0 || ::stat(program_path().c_str(), &program) != 0) return false;
    if (state.st_uid != ::geteuid() && state.st_uid != 0 && state.st_uid != program.st_uid) return false;
    if (state.st_mode & S_IWOTH) return false;
    if (!(state.st_mode & S_IWGRP) || state.st_gid == 0) return true;
    const passwd* user = ::getpwuid(state.st_uid);
    const group* members = ::getgrgid(state.st_gid);
    return user && members && user->pw_gid == state.st_gid && std::string_view(user->pw_name) == members->gr_name;
}

// Returns whether a folder is share/hausbench of an installation. Though it has a manifest, it is not a project:
// results and the cache do not belong there.
bool is_installed(const fs::path& folder) {
    return folder.filename() == "hausbench" && folder.parent_path().filename() == "share";
}

// Returns whether a folder is the root of a project. Throws InputError if it is, but another user can write to it.
bool is_root(const fs::path& folder) {
    if (is_installed(folder)) return false;
    std::error_code unreadable;
    if (!fs::exists(folder / "datasets" / "manifest.toml", unreadable)) return false;
    for (const fs::path& place : {folder, folder / "datasets", folder / "datasets" / "manifest.toml"}) {
        if (is_ours(place)) continue;
        throw InputError(
            fmt::format("{}: another user can write to it, so the models of {} are not used: set HAUSBENCH_ROOT to a "
                        "checkout that you trust",
                        place.string(), (folder / "datasets" / "manifest.toml").string()));
    }
    return true;
}

}  // namespace

fs::path program_path() {
    std::error_code unreadable;
    fs::path path = fs::read_symlink("/proc/self/exe", unreadable);
    if (unreadable)
        throw InputError("/proc/self/exe: it cannot be read, and the program needs it: mount -t proc proc /proc");
    return path;
}

std::optional<fs::path> find_project_root() {
    if (const char* root = std::getenv("HAUSBENCH_ROOT")) {
        std::error_code ignored;
        if (fs::exists(fs::path(root) / "datasets" / "manifest.toml", ignored)) return root;
        throw InputError(
            fmt::format("HAUSBENCH_ROOT={}: no datasets/manifest.toml in it: set it to the checkout", root));
    }
    for (const fs::path& start : {fs::current_path(), program_path().parent_path()}) {
        for (fs::path folder = start; folder.has_relative_path(); folder = folder.parent_path()) {
            if (is_root(folder)) return folder;
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

fs::path installed_folder() { return program_path().parent_path().parent_path() / "share" / "hausbench"; }

fs::path manifest_file() {
    const fs::path file = find_project_root().value_or(installed_folder()) / "datasets" / "manifest.toml";
    return fs::exists(file) ? file : fs::path();
}

fs::path experiments_folder() { return find_project_root().value_or(installed_folder()) / "experiments"; }

fs::path results_folder(const fs::path& experiment) {
    if (std::getenv("HAUSBENCH_ROOT")) return project_root() / "results";
    std::error_code unreadable;
    const fs::path file = fs::weakly_canonical(fs::absolute(experiment), unreadable);
    for (fs::path folder = file.parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
        if (!is_installed(folder) && fs::exists(folder / "datasets" / "manifest.toml", unreadable))
            return folder / "results";
    }
    return "results";
}

fs::path cache_folder() {
    if (const char* cache = std::getenv("HAUSBENCH_CACHE")) return cache;
    if (const auto root = find_project_root()) return *root / "datasets" / "cache";
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && fs::path(cache).is_absolute())
        return fs::path(cache) / "hausbench";
    if (const char* home = std::getenv("HOME"); home && fs::path(home).is_absolute())
        return fs::path(home) / ".cache" / "hausbench";
    throw InputError("no folder for prepared models: set HAUSBENCH_CACHE to a folder");
}

}  // namespace hausbench
