// Writes files atomically: a reader sees all of a file or none of it.
#pragma once

#include <filesystem>
#include <string>

namespace hausbench {

// Creates a file for writing, and returns its descriptor; -1, with errno set, if it cannot. Whatever has that name is removed first, so that
// nothing is written through a link or into a pipe.
int create_afresh(const std::filesystem::path& file);

// Under another name first, NAME.unfinished-PID. Throws InputError where it cannot be written.
void write_whole_file(const std::filesystem::path& file, const std::string& bytes);

// Throws InputError before any work is done if the folder is no place to write, or the file is there and not a regular one.
void check_place_to_write(const std::filesystem::path& file);

// Whether two names lead to one file, also through links and if it does not exist yet.
bool is_same_file(const std::filesystem::path& one, const std::filesystem::path& other);

}  // namespace hausbench
