// Verbs that are Python programs of the project.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hausbench {

// Replaces this program by `python3 -P -m MODULE GIVEN...`, or by the script MODULE if it ends in .py, so that Ctrl-C and the exit code
// are those of what runs. `folder` has the module's package and comes first in PYTHONPATH. Python is PYTHON or /usr/bin/python3;
// HAUSBENCH_PROGRAM is this program. Returns only by InputError.
[[noreturn]] void become_python(const std::string& verb, const std::filesystem::path& folder, const std::string& module,
                                const std::vector<std::string>& given);

// The checkout, or share/hausbench of the installation, whichever has this file. Throws InputError if neither has.
std::filesystem::path folder_with(const std::string& verb, const std::filesystem::path& file);

}  // namespace hausbench
