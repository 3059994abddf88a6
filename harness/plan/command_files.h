// Finds the programs and files that a shell command names.
#pragma once

#include "algorithms/options.h"
#include "algorithms/solver.h"

#include <filesystem>
#include <string>

namespace hausbench {

struct CommandFiles {
    std::string sha256;   // of the contents of all files, in the order of the words; empty if no file is found
    std::string missing;  // error message for the first program that is not found, with a hint; empty if there is none
};

// Finds and hashes the files that a shell command line names:
// - The first word of each command is a program. It is looked up as the shell does: in PATH or, if it contains a slash,
//   relative to `folder`, an absolute path.
// - Any other word counts if it is the name of a file, and so does the part of a word after "=".
// Leaves out words with placeholders such as {A}, with variables or with wildcards, and files that ">" writes. Does not
// see the programs that another program starts. No program is reported as missing if a word such as `cd` may change
// where programs are found.
CommandFiles files_of_command(const std::string& line, const std::filesystem::path& folder);

// Returns whether the solver's answer is the same for every tolerance: SolverInfo says so, or the solver is `external`
// and its command line does not mention the tolerance.
bool ignores_tolerance(const SolverInfo& info, const ParameterMap& options);

}  // namespace hausbench
