// Protects against result files, and shapes in the cache, that are damaged or made to do harm.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace hausbench {

// How reading in a copy of this process ended.
struct CopyEnd {
    enum class Kind { returned, threw, newer };  // newer: threw NewerResult
    Kind kind;
    std::string text;  // what `read` returned, or the message of its exception
};

// Calls `read` in a child process within limits of time and memory that grow with the size of the file, because the
// HDF5 library crashes on some damaged files, loops for ever on others, and takes any amount of memory. Returns how the
// call ended. Throws std::runtime_error if the child did not survive.
CopyEnd read_in_a_copy(const std::filesystem::path& file, const std::function<std::string()>& read);

// Returns why other programs must not open an HDF5 file, on one line; an empty string if they may. The file must be a
// regular file with a correct seal or none, and contain all its values (File::expect_self_contained). Whether it is a
// result is not checked. Assumes that nobody changes the file between this call and the use of its answer.
std::string problem_of(const std::filesystem::path& file);

// Returns the content hash of a file in the cache of shapes. Returns a sentence, which has spaces, if the file cannot be
// read, and an empty string if it is a file of another kind.
std::string content_hash_in(const std::filesystem::path& file);

}  // namespace hausbench
