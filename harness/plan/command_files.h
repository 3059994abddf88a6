// Finds the programs and files that a shell command names.
#pragma once

#include "algorithms/options.h"
#include "algorithms/solver.h"

#include <filesystem>
#include <string>

namespace hausbench {

struct CommandFiles {
    std::string sha256;   // of the contents of all files, in order; empty if none is found
    std::string missing;  // names a program that is not found, with the remedy; empty if there is none
};

// Returns the files that a command line names. The first word of each command is a program, looked up as the shell
// does: in PATH or, if it contains a slash, relative to `folder` (absolute). Any other word, and the part of a word
// after "=", counts if it is the name of a file. Skips words with placeholders such as {A}, variables or wildcards,
// the files that ">" writes, and programs that another program starts.
CommandFiles files_of_command(const std::string& line, const std::filesystem::path& folder);

// Returns whether answers do not depend on the tolerance: the solver says so, or it is `external` and its command
// line does not mention the tolerance.
bool ignores_tolerance(const SolverInfo& info, const ParameterMap& options);

}  // namespace hausbench
