// Python programs of the project that verbs call.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace hausbench {

// Returns the command line of a verb for a script. Positional arguments come first, because an option with several
// values would swallow them; a file -a.off becomes ./-a.off.
std::vector<std::string> words_of(const CLI::App& verb);

// Returns the folder that contains this file: the checkout, or share/hausbench of the installation. Throws InputError
// if neither contains it.
std::filesystem::path folder_with(const std::string& verb, const std::filesystem::path& file);

// Replaces this process with `python3 -P -m MODULE GIVEN...` (or `python3 MODULE GIVEN...` if MODULE ends in .py), so
// that Ctrl-C and the exit code work as if Python had been called directly. Puts `folder`, which contains the module's
// package, first in PYTHONPATH. The environment variable PYTHON chooses another Python; HAUSBENCH_PROGRAM is set to
// this program. Never returns; throws InputError if Python cannot be started.
[[noreturn]] void become_python(const std::string& verb, const std::filesystem::path& folder, const std::string& module,
                                const std::vector<std::string>& given);

}  // namespace hausbench
