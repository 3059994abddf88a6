// Folders for files that live as long as a computation, and what keeps them from being left behind.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace hausbench {

// A folder of its own, TMPDIR/hausbench-KIND-XXXXXX, gone with this object. A lock on it ends with this process whatever
// becomes of that: the first folder of a process sweeps away those that nobody holds any more.
class ScratchFolder {
public:
    // Throws InputError where there is no room for one.
    explicit ScratchFolder(std::string_view kind);
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
    int lock_ = -1;
};

// While one lives, Ctrl-C (SIGINT) and SIGTERM wait, where they would end this process at once: whoever waits for
// something asks came() and leaves off. The last one to go lets the signal do what it does, when all is cleared away.
// For one thread.
class HoldInterrupts {
public:
    HoldInterrupts();
    ~HoldInterrupts();
    HoldInterrupts(const HoldInterrupts&) = delete;
    HoldInterrupts& operator=(const HoldInterrupts&) = delete;

    static bool came();
};

}  // namespace hausbench
