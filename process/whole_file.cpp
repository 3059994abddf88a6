#include "process/whole_file.h"

#include "algorithms/error.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

namespace hausbench {

namespace fs = std::filesystem;

void expect_no_device(const fs::path& file) {
    std::error_code gone;
    const fs::file_status status = fs::status(file, gone);
    if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status))
        throw InputError(
            fmt::format("{}: is not a regular file: copy what it gives to a file, and name that", file.string()));
}

int create_afresh(const fs::path& file) {
    ::unlink(file.c_str());
    return ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
}

void write_whole_file(const fs::path& file, const std::string& bytes) {
    const fs::path unfinished = fmt::format("{}.unfinished-{}", file.string(), ::getpid());
    std::error_code failed;
    errno = 0;
    const int out = create_afresh(unfinished);
    bool good = out >= 0;
    for (std::size_t done = 0; good && done < bytes.size();) {
        const ssize_t n = ::write(out, bytes.data() + done, bytes.size() - done);
        if (n > 0) done += std::size_t(n);
        good = n > 0 || (n < 0 && errno == EINTR);
    }
    if (!good) failed = std::error_code(errno ? errno : EIO, std::generic_category());
    if (out >= 0 && ::close(out) != 0 && !failed) failed = std::error_code(errno, std::generic_category());
    if (!failed) fs::rename(unfinished, file, failed);
    if (!failed) return;
    std::error_code ignored;
    fs::remove(unfinished, ignored);
    throw InputError(
        fmt::format("{}: cannot be written ({}): choose another place, or make room", file.string(), failed.message()));
}

void check_place_to_write(const fs::path& file) {
    const fs::path folder = file.has_parent_path() ? file.parent_path() : ".";
    std::error_code missing;
    if (!fs::is_directory(folder, missing))
        throw InputError(fmt::format("{}: its folder does not exist: make it, or choose another place", file.string()));
    std::error_code loop;
    const fs::file_status status = fs::status(file, loop);
    if (fs::exists(status) && !fs::is_regular_file(status))
        throw InputError(fmt::format("{}: is not a regular file: choose another place", file.string()));
    if (::access(folder.c_str(), W_OK) != 0 || (loop && status.type() != fs::file_type::not_found))
        throw InputError(fmt::format("{}: cannot be written: choose another place", file.string()));
}

bool is_same_file(const fs::path& one, const fs::path& other) {
    std::error_code missing, failed;
    if (one.empty() || other.empty()) return false;
    if (fs::equivalent(one, other, missing)) return true;
    const fs::path place = fs::weakly_canonical(fs::absolute(one), failed);
    return !failed && place == fs::weakly_canonical(fs::absolute(other), failed) && !failed;
}

}  // namespace hausbench
