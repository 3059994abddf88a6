// The last line of an HDF5 file that was written here: the SHA-256 of all bytes before it. HDF5 passes over it, and a program that changes the
// file through HDF5 cuts it off.
#pragma once

#include "datasets/hash.h"

#include <filesystem>
#include <string>

namespace hausbench::h5 {

// The line for the bytes that the hash has taken.
std::string seal_of(Sha256& hash);

// Throws std::runtime_error, with the file, if something follows the data of an HDF5 file that is not their seal: the library itself may crash
// or loop for ever on damaged files. Nothing follows the data of a file that another program changed. O(size of the file).
void check_seal(const std::filesystem::path& file);

}  // namespace hausbench::h5
