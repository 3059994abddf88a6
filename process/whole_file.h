// Writes files atomically: a reader sees all of a file or none of it.
#pragma once

#include <filesystem>
#include <string>

namespace hausbench {

// Under another name first. Throws InputError where it cannot be written.
void write_whole_file(const std::filesystem::path& file, const std::string& bytes);

// Throws InputError where its folder is no place to write, before any work is done.
void check_place_to_write(const std::filesystem::path& file);

}  // namespace hausbench
