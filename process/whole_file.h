// Writes files atomically, so that a reader sees all of a file or none of it, and refuses what is no file.
#pragma once

#include <filesystem>
#include <string>

namespace hausbench {

// Throws InputError if the path leads to a pipe, a device or anything else that is neither a regular file nor a folder:
// reading it could wait or go on for ever. Says nothing about a missing file.
void expect_no_device(const std::filesystem::path& file);

// Creates a file for writing and returns its descriptor, or -1 with errno set on failure. First removes a file, link or
// pipe of that name, so that nothing is written through a link or into a pipe.
int create_afresh(const std::filesystem::path& file);

// Writes a file under the name NAME.unfinished-PID, then renames it to NAME. Throws InputError if it cannot be written.
void write_whole_file(const std::filesystem::path& file, const std::string& bytes);

// Throws InputError if the folder of the file does not exist or cannot be written to, or if the file exists but is not
// a regular file. Call it early, so that the error is found before the work is done.
void check_place_to_write(const std::filesystem::path& file);

// Returns whether two paths lead to the same file, also through links. The file does not have to exist yet.
bool is_same_file(const std::filesystem::path& one, const std::filesystem::path& other);

}  // namespace hausbench
