// The origin of results: the build of the program, the machine and the time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>

namespace hausbench {

struct Build {
    std::string commit;  // of the sources; "unknown" outside a checkout; not part of the id
    std::string dirty;   // "yes", "no" or "unknown"
    std::string version, compiler, flags, type;
    std::string libraries;  // JSON object: name -> version
};

struct Machine {
    std::string id;  // SHA-256 of the other members
    std::string cpu, caches, kernel, system;
    std::int64_t cores = 0, memory_bytes = 0;
};

const Build& this_build();
// Returns the SHA-256 of the program file, so every change of the code changes it. Computed at the first call, which
// takes 10 ms.
const std::string& build_id();
std::string version_text();  // one line: version, commit, build type, compiler
const Machine& this_machine();

// Returns the build that contains a solver: the id of the program or, for a solver in a plug-in, a hash of program and
// plug-in. A resumed run keeps only answers of the same build.
const std::string& build_of(const std::string& solver);

// Returns the SHA-256 of each plug-in file. Computed at the first call.
const std::map<std::filesystem::path, std::string>& plugin_hashes();

// Returns JSON with the file name, SHA-256, compiler and solvers of each plug-in.
std::string plugins_json();

// Returns a JSON object that maps the name of each solver to its title.
std::string titles_json();

// Finds the build of the program that made a row, given the column `build` of the row. For a solver in a plug-in, this
// column is a hash of program and plug-in, but its times are still comparable with times of built-in solvers, because
// one program ran both.
class Programs {
public:
    explicit Programs(const std::map<std::string, std::string>& texts);  // ResultFile::texts

    // Returns the build of the program alone.
    const std::string& of(const std::string& build) const { return with_plugin_.contains(build) ? program_ : build; }

private:
    std::string program_;
    std::set<std::string> with_plugin_;
};

std::string utc_now();  // "2026-11-21T03:29:32Z"

}  // namespace hausbench
