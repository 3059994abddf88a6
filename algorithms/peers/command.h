// Runs a shell command with a time limit and keeps its output.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace hausbench {

struct CommandRun {
    bool timed_out = false;
    std::string failure;  // "" for exit code 0, else "exit code 3" or "signal 11 (Segmentation fault)"
    std::string output;   // standard output and error, interleaved as written; at most the last 16 MB
    // Peak resident set of the largest process; -1 if it is below that of this process when it started the command, because
    // the kernel counts the latter too.
    std::int64_t peak_bytes = -1;
};

// Runs `/bin/sh -c line` in `folder` (empty: the current one) and in a process group of its own, with no input. It is killed after `seconds`, or at a deferred
// interrupt (scratch.h). When it ends, all processes that it started are killed, even those that left the group. The group
// also ends with this process, which becomes a subreaper. Throws std::runtime_error if the command cannot be started.
CommandRun run_command(const std::string& line, double seconds, const std::filesystem::path& folder = {});

}  // namespace hausbench
