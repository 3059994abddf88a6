// Finds the programs and files that a shell command names.
#pragma once

#include "algorithms/options.h"
#include "algorithms/solver.h"

#include <filesystem>
#include <string>

namespace hausbench {

struct CommandFiles {
    std::string sha256;   // of the contents of all of them, in order; empty where none is found
    std::string missing;  // a program that is nowhere, with the remedy; empty where there is none
};

// The first word of each command is a program, looked up as the shell does: in PATH, or where it has a slash, from `folder`
// (absolute). Any other word, and the part of a word after "=", counts where it is the name of a file. Passed over
// are words with placeholders such as {A}, variables or wildcards, what ">" writes, and programs that a program starts itself.
CommandFiles files_of_command(const std::string& line, const std::filesystem::path& folder);

// Whether answers do not depend on the tolerance: the solver says so, or it is `external` with a command line that does not name {tolerance}.
bool ignores_tolerance(const SolverInfo& info, const ParameterMap& options);

}  // namespace hausbench
