// A worker process, for its runner: start it, send its input, receive its events, watch its memory, end it.
#pragma once

#include "scratch.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace hausbench {

class WorkerProcess {
public:
    // Starts `program worker` in a process group of its own (Ctrl-C at the terminal reaches only the runner) and writes
    // `input` to its standard input. It and its descendants end with the runner. Its TMPDIR is a folder of its own
    // (scratch.h). Throws InputError if that folder cannot be created.
    WorkerProcess(const std::filesystem::path& program, const std::string& input);
    // A copy of this process (fork) that does `work` with the descriptor of the events, and ends; otherwise likewise, but its standard output
    // goes to this one's standard error. For a process without other threads.
    explicit WorkerProcess(const std::function<void(int events)>& work);
    ~WorkerProcess();  // kills it if it still runs
    WorkerProcess(const WorkerProcess&) = delete;
    WorkerProcess& operator=(const WorkerProcess&) = delete;

    enum class Heard { line, nothing, closed };

    // Waits up to `wait` for the next line of its events.
    Heard listen(std::chrono::milliseconds wait, std::string& line);

    std::int64_t resident_bytes() const;  // including its descendants; 0 if it has ended

    void kill();  // the process and its descendants

    // How it ended: "" for exit code 0, else "signal 11 (Segmentation fault)" or "exit code 3". Waits for it.
    std::string end();
    bool ended_within(std::chrono::milliseconds wait);
    std::optional<int> signal() const;

    // The end of its standard error and output, at most `characters` characters, on one line.
    std::string last_words(std::size_t characters = 400);

private:
    struct Pipes;
    void start(Pipes& pipes, const std::function<void()>& child);
    void read_output();

    pid_t pid_ = -1;
    int events_ = -1, output_ = -1;
    bool output_open_ = true;
    std::string buffer_, said_;  // events not yet returned; the end of its output
    ScratchFolder folder_;
    std::vector<pid_t> before_;  // children of this process from before
    std::optional<int> status_;
};

}  // namespace hausbench
