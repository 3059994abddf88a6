// Makes temporary folders that are removed with their object. Folders left behind by a killed process are recognised by
// their missing lock.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace hausbench {

// A temporary folder TMPDIR/hausbench-KIND-XXXXXX, removed with this object. This process holds a lock on the folder,
// which the kernel releases however the process ends. Before a process makes its first folder, it removes unlocked
// folders with such names, which killed processes left behind.
class ScratchFolder {
public:
    // `kind`: one of `kinds` in scratch.cpp; a folder of another kind would not be recognised if it were left behind.
    // Throws InputError if no folder can be made or locked.
    explicit ScratchFolder(std::string_view kind);
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }

private:
    bool try_to_make(std::string pattern);

    std::filesystem::path path_;
    int lock_ = -1;
};

}  // namespace hausbench
