// Reads foreign files, and runs simplify and remesh, in a separate process, so that a crash of a library does no harm.
#pragma once

#include "datasets/generate.h"
#include "datasets/load.h"

#include <cstdint>
#include <functional>

namespace hausbench {

// Runs `program load [--format F] [--columns C] [--drop-invalid] -- FILE OUT.h5`, a hidden command of hausbench, and
// reads the shape that it wrote.
// Throws InputError with the child's own message, or "the reader was killed by signal N", or "did not finish within
// N s", or "was stopped when it took more than N MB of memory". `bytes_limit` limits the resident set, not the address
// space, of which sanitizer builds reserve far more than they use; 0: three quarters of the free memory.
// `waiting`, if it is not empty, is called every few milliseconds.
LoadedShape load_separately(const std::filesystem::path& program, const std::filesystem::path& file,
                            const LoadOptions& options = {}, const std::function<void()>& waiting = {},
                            double seconds_limit = 120, std::int64_t bytes_limit = 0);

// Runs derive() in a separate process: `program derive --set NAME=VALUE... -- OPERATION ORIGIN.h5 OUT.h5`. `origin` is
// the file of the shape that the operation is applied to. Throws InputError in the same cases as load_separately().
LoadedShape derive_separately(const std::filesystem::path& program, const std::string& operation,
                              const Numbers& numbers, const std::filesystem::path& origin,
                              const std::function<void()>& waiting = {}, double seconds_limit = 120,
                              std::int64_t bytes_limit = 0);

}  // namespace hausbench
