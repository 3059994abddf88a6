// Runs a command line of the shell as an outside program is run: with a time limit, its output kept.
#pragma once

#include <cstdint>
#include <string>

namespace hausbench {

struct CommandRun {
    bool timed_out = false;
    std::string failure;  // "" for exit code 0, else "exit code 3" or "signal 11 (Segmentation fault)"
    std::string output;   // standard output and error as they came; of very much, the last 16 MB
    // Peak resident set of the largest process; -1 where it stayed below what this process had when it started the command,
    // since the kernel counts that in.
    std::int64_t peak_bytes = -1;
};

// `/bin/sh -c line` in a process group of its own, with no input; it is killed after `seconds` or at an interrupt that is held
// (scratch.h); when it ends, whatever it has started is killed, also what has left the group. The group dies with this
// process, which becomes a subreaper. Throws std::runtime_error if nothing could be started.
CommandRun run_command(const std::string& line, double seconds);

}  // namespace hausbench
