#include "harness/commands/python_module.h"

#include "algorithms/error.h"
#include "datasets/paths.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <unistd.h>

namespace hausbench {

namespace fs = std::filesystem;

[[noreturn]] void become_python(const std::string& verb, const fs::path& folder, const std::string& module,
                                const std::vector<std::string>& given) {
    const char* chosen = std::getenv("PYTHON");
    const std::string python = chosen && *chosen ? chosen : "/usr/bin/python3";
    std::vector<std::string> words{python};
    if (module.ends_with(".py"))
        words.push_back(module);
    else
        words.insert(words.end(), {"-P", "-m", module});  // -P: no modules of the current folder
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

}  // namespace hausbench
