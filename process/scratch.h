// Makes temporary folders that are removed with their object; a lock shows which ones a killed process left behind.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace hausbench {

// A temporary folder TMPDIR/hausbench-KIND-XXXXXX, removed with this object. This process holds a lock on the folder,
// which the kernel releases however the process ends. Before a process makes its first folder, it removes folders of
// such a name that no process has locked: they were left behind by killed processes.
class ScratchFolder {
public:
    // `kind`: one of `kinds` in scratch.cpp; folders of other kinds would never be recognised as left behind. Throws
    // InputError if no folder can be made or locked, and then leaves none behind.
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
