// Writes files atomically: a reader sees all of a file or none of it.
#pragma once

#include <filesystem>
#include <string>

namespace hausbench {

// Creates a file for writing and returns its descriptor, or -1 with errno set if it cannot. First removes whatever
// has that name, so that nothing is written through a link or into a pipe.
int create_afresh(const std::filesystem::path& file);

// Writes a file, first under the name NAME.unfinished-PID, which is then renamed. Throws InputError if it cannot be
// written.
void write_whole_file(const std::filesystem::path& file, const std::string& bytes);

// Throws InputError, before any work is done, if the folder cannot be written to, or if the file exists but is not a
// regular file.
void check_place_to_write(const std::filesystem::path& file);

// Returns whether two names lead to the same file, also through links and if it does not exist yet.
bool is_same_file(const std::filesystem::path& one, const std::filesystem::path& other);

}  // namespace hausbench
