// `hausbench draw`, `fetch` and `track`: verbs implemented by Python programs of the project.
#include "harness/commands/scripts.h"

#include "algorithms/error.h"
#include "datasets/paths.h"
#include "harness/commands/verb.h"

#include <fmt/format.h>

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

// The number of values that an option takes. The Python scripts define the same options again; a test compares both.
enum class Takes { nothing, value, values };

void take(CLI::App* verb, const std::string& name, Takes takes, const std::string& value, const std::string& meaning) {
    static std::deque<std::vector<std::string>> given;  // a deque, because options point into it
    static std::deque<bool> flags;
    if (takes == Takes::nothing)
        verb->add_flag(name, flags.emplace_back(), meaning);
    else
        verb->add_option(name, given.emplace_back(), meaning)
            ->type_name(value)
            ->allow_extra_args(takes == Takes::values);
}

}  // namespace

std::vector<std::string> words_of(const CLI::App& verb) {
    std::vector<std::string> positionals, options;
    for (const CLI::Option* option : verb.get_options()) {
        if (option->count() == 0) continue;
        const std::vector<std::string>& values = option->results();
        if (option->get_lnames().empty()) {
            for (const std::string& value : values)
                positionals.push_back(value.starts_with('-') ? "./" + value : value);
            continue;
        }
        const std::string name = "--" + option->get_lnames().front();
        if (option->get_items_expected_max() == 0) {
            options.push_back(name);
        } else if (option->get_allow_extra_args()) {
            options.push_back(name);
            options.insert(options.end(), values.begin(), values.end());
        } else {
            for (const std::string& value : values) options.push_back(fmt::format("{}={}", name, value));
        }
    }
    positionals.insert(positionals.end(), options.begin(), options.end());
    return positionals;
}

void become_python(const std::string& verb, const fs::path& folder, const std::string& module,
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

fs::path folder_with(const std::string& verb, const fs::path& file) {
    if (const auto root = find_project_root(); root && fs::exists(*root / file)) return *root;
    if (fs::exists(installed_folder() / file)) return installed_folder();
    throw InputError(
        fmt::format("{}: found no {}: run it in a checkout, or set HAUSBENCH_ROOT to one", verb, file.string()));
}

// Adds the verb `draw`, which makes tables and figures of a result with analysis/draw.py.
void add_draw(CLI::App& app, int&) {
    auto* verb = add_verb(app, "draw", "draws tables and figures of a result, for papers",
                          "hausbench draw results/zhang2017_table3.h5 --as table");
    take(verb, "result", Takes::value, "FILE", "result file (.h5)");
    take(verb, "--as", Takes::value, "table|error-against-time|performance-profile|motion",
         "what to draw; may be repeated (default: everything that the result has data for)");
    take(verb, "--highlight", Takes::value, "LABEL", "draws this solver in front of the others, which become grey");
    take(verb, "--width", Takes::value, "WIDTH",
         "of figures: single (3.5 inches), double (7.16) or inches (default: double)");
    take(verb, "--format", Takes::value, "FORMATS", "of figures: a list of pdf, png and svg (default: pdf,png)");
    take(verb, "--out", Takes::value, "FOLDER", "parent of tables/ and figures/ (default: the folder of the result)");
    verb->get_option("result")->required()->expected(1);
    verb->callback([verb] {
        ::setenv("HAUSBENCH_CACHE", cache_folder().c_str(), 1);  // where the script finds the shapes of the result
        become_python("draw", folder_with("draw", "analysis/draw.py"), "analysis.draw", words_of(*verb));
    });
}

// Adds the verb `fetch`, which copies meshes from packages into the cache with datasets/fetch.py.
void add_fetch(CLI::App& app, int&) {
    auto* verb =
        add_verb(app, "fetch", "fetches models from the Debian packages that have them", "hausbench fetch bunny");
    take(verb, "models", Takes::values, "MODEL", "models of the manifest (default: all)");
    take(verb, "--corpus", Takes::nothing, "", "also all meshes of the corpus");
    take(verb, "--experiment", Takes::values, "FILE", "also the meshes of the corpus that these experiments use");
    take(verb, "--profile", Takes::value, "PROFILE", "profile of those experiments (default: quick)");
    take(verb, "--check", Takes::nothing, "", "hashes the files that are there; fetches a damaged one again");
    take(verb, "--manifest", Takes::value, "FILE", "list of models (default: the project's)");
    take(verb, "--cache", Takes::value, "FOLDER", "where the meshes go (default: the project's cache)");
    verb->callback([verb] {
        ::setenv("HAUSBENCH_CACHE", cache_folder().c_str(), 1);
        const auto folder = folder_with("fetch", "datasets/fetch.py");
        become_python("fetch", folder, (folder / "datasets" / "fetch.py").string(), words_of(*verb));
    });
}

// Adds the verb `track`, which tests whether the solvers of a checkout have become slower. bench/tracking is in Python,
// because its statistics use scipy.
void add_track(CLI::App& app, int&) {
    auto* verb = add_verb(
        app, "track", "tells whether solvers have become slower", "hausbench track --base main --tiers counters,time",
        "Exit codes: 0: no; 3: yes, or the baseline no longer fits; 4: open, because the test of the timing "
        "itself failed; 5: something broke. docs/tracking.md describes the tiers.");
    take(verb, "--base", Takes::value, "REVISION", "commit to compare with (default: HEAD)");
    take(verb, "--base-program", Takes::value, "FILE", "its program, if it is already built");
    take(verb, "--tiers", Takes::value, "TIERS", "list of counters, instructions and time (default: all three)");
    take(verb, "--blocks", Takes::value, "N",
         "most blocks of each side for a case that looks slower after 24 (default: 48)");
    take(verb, "--case", Takes::value, "NAME", "only cases whose names begin with this; may be repeated");
    take(verb, "--update", Takes::value, "REASON",
         "writes a new baseline of counters and instructions, with the reason");
    take(verb, "--record", Takes::value, "FILE", "where all measurements go (default: results/tracking.json)");
    for (const char* name : {"--program", "--baseline"}) {  // for tests
        take(verb, name, Takes::value, "FILE", "");
        verb->get_option(name)->group("");
    }
    verb->callback([verb] {
        become_python("track", folder_with("track", "bench/tracking/__main__.py"), "bench.tracking", words_of(*verb));
    });
}

}  // namespace hausbench
