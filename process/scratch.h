// Makes temporary folders that are removed with their object; a lock shows which ones a killed process left behind.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace hausbench {

// A temporary folder TMPDIR/hausbench-KIND-XXXXXX, removed with this object. A lock marks it as used until this
// process ends in any way. Before a process makes its first folder, it removes the folders that no process has
// locked.
class ScratchFolder {
public:
    // Throws InputError if no folder can be made or locked, and then leaves none behind.
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
