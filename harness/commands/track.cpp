// `hausbench track`: whether the solvers of a checkout have become slower. What it does is bench/tracking, where scipy is.
#include "commands/verb.h"
#include "error.h"
#include "paths.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <unistd.h>

namespace hausbench {

namespace {

namespace fs = std::filesystem;

// In place of this program, so that Ctrl-C and the exit code are those of what runs. Returns only by an error.
[[noreturn]] void become_tracker(const std::vector<std::string>& given) {
    const fs::path root = project_root();
    if (!fs::exists(root / "bench" / "tracking" / "__main__.py"))
        throw InputError(fmt::format("track: {} has no bench/tracking: run it in a checkout", root.string()));
    const char* chosen = std::getenv("PYTHON");
    const std::string python = chosen && *chosen ? chosen : "/usr/bin/python3";
    std::vector<std::string> words{python, "-P", "-m", "bench.tracking"};  // -P: no modules of the folder at hand
    words.insert(words.end(), given.begin(), given.end());
    const fs::path program = program_path();
    const char* paths = std::getenv("PYTHONPATH");
    const std::string with_ours = root.string() + (paths && *paths ? std::string(":") + paths : "");
    if (::setenv("HAUSBENCH_PROGRAM", program.c_str(), 1) != 0 || ::setenv("PYTHONPATH", with_ours.c_str(), 1) != 0)
        throw InputError(fmt::format("track: {}", std::strerror(errno)));
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    std::fflush(stdout);
    ::execvp(python.c_str(), argv.data());
    throw InputError(fmt::format("track: cannot run {}: {}; set PYTHON to a Python 3.11 that has scipy and h5py",
                                 python, std::strerror(errno)));
}

}  // namespace

void add_track(CLI::App& app, int&) {
    auto* verb = app.add_subcommand(
        "track",
        "tell whether solvers have become slower: work counters, instructions, then times beside an older build");
    verb->prefix_command();  // all that follows is for the tracker, --help too
    verb->set_help_flag();
    verb->callback([verb] { become_tracker(verb->remaining()); });
}

}  // namespace hausbench
