// Reads foreign files, and simplifies and remeshes, in a separate process, so that a crash of a library does no harm.
#pragma once

#include "datasets/generate.h"
#include "datasets/load.h"

#include <cstdint>

namespace hausbench {

// Starts `program load [--format F] -- FILE OUT.h5` (the harness's hidden verb), waits, reads the shape it wrote. Throws
// InputError with the child's own message, or "the reader was killed by signal N", or "did not finish within N s", or
// "was stopped when it took more than N MB of memory". `bytes_limit` is on its resident set (a limit on the address
// space would end sanitizer builds at once); 0: three quarters of the memory that is free.
LoadedShape load_separately(const std::filesystem::path& program, const std::filesystem::path& file,
                            const std::string& format = "", double seconds_limit = 120, std::int64_t bytes_limit = 0);

// derive() in a process of its own, `program derive --set NAME=VALUE... -- OPERATION ORIGIN.h5 OUT.h5`; errors likewise.
LoadedShape derive_separately(const std::filesystem::path& program, const std::string& operation,
                              const Numbers& numbers, const std::filesystem::path& origin, double seconds_limit = 120,
                              std::int64_t bytes_limit = 0);

}  // namespace hausbench
