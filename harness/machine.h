// Where numbers come from: the build, the machine, the time.
#pragma once

#include <cstdint>
#include <string>

namespace hausbench {

struct Build {
    std::string id;         // SHA-256 of the program: changes when anything that could change an answer does
    std::string commit;     // of the sources, "unknown" outside a checkout; not part of the id
    std::string dirty;      // "yes", "no" or "unknown"
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

std::string utc_now();  // "2026-11-21T03:29:32Z"

}  // namespace hausbench
