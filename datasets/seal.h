// The last line of an HDF5 file written by this program: the SHA-256 of all bytes before it. HDF5
// ignores it, and a program that changes the file through HDF5 cuts it off.
#pragma once

#include "datasets/hash.h"

#include <filesystem>
#include <string>

namespace hausbench::h5 {

// Returns the line for the bytes added to the hash.
std::string seal_of(Sha256& hash);

// Throws std::runtime_error, with the file, if something other than the right seal follows the
// data of an HDF5 file, because the library itself may crash or loop for ever on damaged files.
// Accepts a file without a seal, which another program changed. O(size of the file).
void check_seal(const std::filesystem::path& file);

}  // namespace hausbench::h5
