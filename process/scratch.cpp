#include "process/scratch.h"

#include "algorithms/error.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view prefix = "hausbench-";
constexpr int most_tries = 100;
constexpr std::array<std::string_view, 5> kinds = {"worker", "load", "derive", "external", "verify"};

bool is_ours(const std::string& name) {
    for (const std::string_view kind : kinds) {
        if (name.starts_with(fmt::format("{}{}-", prefix, kind))) return true;
    }
    return false;
}

bool remove_abandoned_folders(const fs::path& from) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(from, ignored)) {
        struct stat state {};
        if (!is_ours(entry.path().filename().string()) || ::lstat(entry.path().c_str(), &state) != 0) continue;
        if (!S_ISDIR(state.st_mode) || state.st_uid != ::getuid()) continue;
        const int lock = ::open(entry.path().c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
        if (lock < 0) continue;
        if (::flock(lock, LOCK_EX | LOCK_NB) == 0) fs::remove_all(entry.path(), ignored);
        ::close(lock);
    }
    return true;
}

}  // namespace

ScratchFolder::ScratchFolder(std::string_view kind) {
    std::error_code error;
    const fs::path temporary = fs::temp_directory_path(error);
    if (error) {
        const char* named = std::getenv("TMPDIR");
        throw InputError(
            fmt::format("{}: no folder for temporary files: name one with TMPDIR", named ? named : "/tmp"));
    }
    static const bool swept = remove_abandoned_folders(temporary);
    static_cast<void>(swept);
    for (int i = 0; i < most_tries; ++i) {
        if (try_to_make((temporary / fmt::format("{}{}-XXXXXX", prefix, kind)).string())) return;
    }
    throw InputError(
        fmt::format("{}: other processes removed {} folders that were just made there: name another place for "
                    "temporary files with TMPDIR",
                    temporary.string(), most_tries));
}

// Makes and locks a folder. Returns false if another process took the new folder for an abandoned one before it was
// locked, and has locked or removed it.
bool ScratchFolder::try_to_make(std::string pattern) {
    const auto fail = [&](const char* what) {
        const int error = errno;
        if (lock_ >= 0) ::close(lock_);
        ::rmdir(pattern.c_str());
        throw InputError(fmt::format("{}: cannot be {} ({}): name another place for temporary files with TMPDIR",
                                     pattern, what, std::strerror(error)));
    };
    if (!::mkdtemp(pattern.data())) fail("made");
    lock_ = ::open(pattern.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (lock_ < 0) {
        if (errno == ENOENT) return false;
        fail("opened");
    }
    struct stat state {};
    const bool held = ::flock(lock_, LOCK_EX | LOCK_NB) == 0;
    if (!held && errno != EWOULDBLOCK) fail("locked");
    if (held && ::stat(pattern.c_str(), &state) == 0) {
        path_ = pattern;
        return true;
    }
    if (held && errno != ENOENT) fail("read");
    ::close(lock_);
    lock_ = -1;
    return false;
}

ScratchFolder::~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
    ::close(lock_);
}

}  // namespace hausbench
