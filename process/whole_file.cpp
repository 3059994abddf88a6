#include "process/whole_file.h"

#include "error.h"

#include <fmt/format.h>

#include <unistd.h>

#include <cerrno>
#include <fstream>

namespace hausbench {

namespace fs = std::filesystem;

void write_whole_file(const fs::path& file, const std::string& bytes) {
    const fs::path unfinished = file.string() + ".unfinished";
    std::error_code failed;
    errno = 0;
    {
        std::ofstream out(unfinished, std::ios::binary);
        out.write(bytes.data(), std::streamsize(bytes.size()));
        out.close();
        if (!out) failed = std::error_code(errno ? errno : EIO, std::generic_category());
    }
    if (!failed) fs::rename(unfinished, file, failed);
    if (!failed) return;
    std::error_code ignored;
    fs::remove(unfinished, ignored);
    throw InputError(
        fmt::format("{}: cannot be written ({}): choose another place, or make room", file.string(), failed.message()));
}

void check_place_to_write(const fs::path& file) {
    const fs::path folder = file.has_parent_path() ? file.parent_path() : ".";
    if (!fs::is_directory(folder))
        throw InputError(fmt::format("{}: its folder does not exist: make it, or choose another place", file.string()));
    if (::access(folder.c_str(), W_OK) != 0 || fs::is_directory(file))
        throw InputError(fmt::format("{}: cannot be written: choose another place", file.string()));
}

}  // namespace hausbench
