// The *seal* of an HDF5 file that this program wrote: its last line, which has the SHA-256 of all bytes before it. The
// HDF5 library ignores the seal, and cuts it off when a program changes the file.
#pragma once

#include "datasets/hash.h"

#include <filesystem>
#include <string>

namespace hausbench::h5 {

// Returns the seal of a file whose bytes were added to `hash`.
std::string seal_of(Sha256& hash);

// Throws std::runtime_error if an HDF5 file ends with a seal that does not match its bytes, or with anything else after
// its data. Call it before HDF5 opens a file, because the library may crash or loop for ever on a damaged one. Accepts
// a file without a seal, because another program may have changed it properly. O(size of the file).
void check_seal(const std::filesystem::path& file);

}  // namespace hausbench::h5
