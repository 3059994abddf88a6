// Where numbers come from: the build, the machine, the time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace hausbench {

struct Build {
    std::string id;      // SHA-256 of the program: changes when anything that could change an answer does
    std::string commit;  // of the sources, "unknown" outside a checkout; not part of the id
    std::string dirty;   // "yes", "no" or "unknown"
    std::string version, compiler, flags, type;
    std::string libraries;  // JSON object: name -> version
};

struct Machine {
    std::string id;  // SHA-256 of the rest
    std::string cpu, caches, kernel, system;
    std::int64_t cores = 0, memory_bytes = 0;
};

const Build& this_build();
const Machine& this_machine();

// The build that answers of this solver are from: the program's, or of program and plug-in together where a plug-in offers
// it. The one place that knows; resuming, and the column `build`, go by it.
const std::string& build_of(const std::string& solver);

// SHA-256 of each plug-in as it was when it was first asked for, by file.
const std::map<std::filesystem::path, std::string>& plugin_hashes();

std::string utc_now();  // "2026-11-21T03:29:32Z"

}  // namespace hausbench
