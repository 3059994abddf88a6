// A worker process as its runner sees it: started, fed, listened to, watched and ended.
#pragma once

#include "scratch.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace hausbench {

class WorkerProcess {
public:
    // Starts `program worker` in a process group of its own (Ctrl-C at the terminal reaches the runner alone) and writes
    // `input` to its standard input. It dies with the runner, and all it has started with it. TMPDIR
    // is a folder of its own (scratch.h). Throws InputError where there can be none.
    WorkerProcess(const std::filesystem::path& program, const std::string& input);
    ~WorkerProcess();  // kills it, if it still runs
    WorkerProcess(const WorkerProcess&) = delete;
    WorkerProcess& operator=(const WorkerProcess&) = delete;

    enum class Heard { line, nothing, closed };

    // Waits up to `wait` for the next line of its events.
    Heard listen(std::chrono::milliseconds wait, std::string& line);

    std::int64_t resident_bytes() const;  // with the processes it has started; 0 when it is gone

    void kill();  // it, and what it has started

    // How it ended: "" for exit code 0, else "signal 11 (Segmentation fault)" or "exit code 3". Waits for it.
    std::string end();
    bool ended_within(std::chrono::milliseconds wait);
    std::optional<int> signal() const;

    // The last lines it wrote to standard error or output, at most `characters` of them, on one line.
    std::string last_words(std::size_t characters = 400);

private:
    void read_output();

    pid_t pid_ = -1;
    int events_ = -1, output_ = -1;
    bool output_open_ = true;
    std::string buffer_, said_;  // events not yet handed on; the end of its output
    ScratchFolder folder_;
    std::vector<pid_t> before_;  // what this process had started before
    std::optional<int> status_;
};

}  // namespace hausbench
