// Starts a child process, reads its output, limits it, and ends it with all its descendants.
#pragma once

#include "process/scratch.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace hausbench {

// The text as one word of a shell.
std::string shell_quoted(const std::string& text);

struct Launch {
    std::vector<std::string> command;  // the program, by its path, and its arguments; or ...
    // ... what a copy of this process does (fork), and its exit code. Only in a process without other threads.
    std::function<int(int events)> work;
    std::filesystem::path folder;  // where it runs; empty: here
    std::string input;             // its standard input; empty: none
    bool events = false;           // pipe for its lines; the last argument is the number of its end
    bool silent = false;           // discards its standard output, and keeps its standard error
    std::size_t kept = 4096;       // characters of the end of its output
    std::string scratch;           // kind of its own scratch folder, its TMPDIR; empty: none
    // With its process group, even if SIGKILL ends this process; one child at a time.
    bool dies_with_parent = false;
    std::vector<int> cores;  // allowed cores, by the kernel's numbers; empty: as this process
};

struct ChildLimits {
    double seconds = std::numeric_limits<double>::infinity();  // wall time from the call of wait()
    std::int64_t resident_bytes = std::numeric_limits<std::int64_t>::max();
};

// It runs in a process group of its own, so that Ctrl-C at the terminal reaches only this process. It ends with this process, and
// with it all its descendants, even those that left the group: this process becomes a subreaper (prctl), so they are found.
// Several threads may each have a child of their own; it ends with the thread that started it (PR_SET_PDEATHSIG).
class Child {
public:
    // Throws InputError where its scratch folder, std::runtime_error where the process cannot be made.
    explicit Child(Launch launch);
    ~Child();  // kills it if it still runs
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    enum class Heard { line, nothing, closed };

    // Waits up to `wait` for the next line of its events. Closed: the other end of the pipe is closed, or the child has ended (then so
    // have its descendants, which may have held it open).
    Heard listen(std::chrono::milliseconds wait, std::string& line);

    // Waits for its end, and kills it at a limit or at a deferred interrupt (interrupts.h).
    enum class End { by_itself, time, memory, interrupt };
    End wait(const ChildLimits& limits);
    bool ended_within(std::chrono::milliseconds wait);

    void kill();  // the process and its descendants

    // How it ended: "" for exit code 0, else "signal 11 (Segmentation fault)" or "exit code 3". Waits for it.
    std::string how_it_ended();
    std::optional<int> signal() const;  // once it has ended
    int exit_code() const;              // likewise

    // Whether it and its descendants together hold more memory. A page that several of them share, as after a fork, counts once.
    bool takes_more_than(std::int64_t bytes) const;

    // Peak resident set of the largest of its processes, once it has ended; -1 if that is below what this process had when it
    // started it, which the kernel counts too.
    std::int64_t peak_bytes() const { return peak_bytes_; }

    // The end of its output.
    const std::string& output();
    std::string last_words(std::size_t characters = 400);  // on one line, as ASCII

private:
    struct Pipes;
    void start(Pipes& pipes, const std::function<void()>& child);
    void feed();
    void read_output();
    void look_for_end(int flags);

    Launch launch_;
    std::optional<ScratchFolder> folder_;
    pid_t pid_ = -1;
    int events_ = -1, output_ = -1, input_ = -1;
    std::size_t fed_ = 0;        // bytes of its input written; it may read slowly, or never
    std::string buffer_, said_;  // events not yet returned; the end of its output
    // This process and its earlier descendants; other living children are spared too.
    std::vector<pid_t> before_;
    std::int64_t own_bytes_ = 0, peak_bytes_ = -1;
    std::optional<int> status_;
};

}  // namespace hausbench
