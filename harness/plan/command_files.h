// Finds the programs and files that a shell command names. Their hash is part of a case's identity, so that a case runs
// again when its program changes.
#pragma once

#include "algorithms/options.h"
#include "algorithms/solver.h"

#include <filesystem>
#include <string>

namespace hausbench {

struct CommandFiles {
    std::string sha256;   // hash of the contents of all files that were found, in the order of the words; empty if none
    std::string missing;  // error message about the first program that is not found; empty if there is none
};

// Finds and hashes the files that a shell command line names.
// - The first word of each command is a program. A name with a slash is relative to `folder`, an absolute path; any
//   other name is looked up in PATH.
// - Any other word counts if a file of that name exists. In a word such as "--mesh=a.off", the part after "=" counts as
//   well.
// - Words with placeholders such as {A}, with variables or with wildcards are ignored, and so are files that ">"
//   writes.
// Programs that are started by another program are not found. If the line contains a command such as `cd`, after which
// a name may lead to another file, no program is reported as missing.
CommandFiles files_of_command(const std::string& line, const std::filesystem::path& folder);

// Returns whether the solver gives the same answer for every tolerance. It does if SolverInfo::ignores_tolerance is
// set, or if the solver is `external` and its command line does not mention the tolerance.
bool ignores_tolerance(const SolverInfo& info, const ParameterMap& options);

}  // namespace hausbench
