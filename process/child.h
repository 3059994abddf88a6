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

// Quotes a text so that a shell reads it as one word.
std::string shell_quoted(const std::string& text);

struct Launch {
    std::vector<std::string> command;  // path of the program and its arguments; or ...
    // ... a function that a copy of this process (fork) runs and whose result is its exit code. Only in a process
    // without other threads.
    std::function<int(int events)> work;
    std::filesystem::path folder;  // working folder; empty: the present one
    std::string input;             // standard input; empty: none
    bool events = false;           // opens a pipe for its lines, whose descriptor becomes its last argument
    bool silent = false;           // discards its standard output and keeps its standard error
    std::size_t kept = 4096;       // number of characters of the end of its output to keep
    std::string scratch;           // kind of the scratch folder that becomes its TMPDIR; empty: none
    // Kills it and its process group when this process ends, even by SIGKILL; one child at a time.
    bool dies_with_parent = false;
    std::vector<int> cores;  // allowed cores, by the kernel's numbers; empty: as for this process
};

struct ChildLimits {
    double seconds = std::numeric_limits<double>::infinity();  // wall time from the call of wait()
    std::int64_t resident_bytes = std::numeric_limits<std::int64_t>::max();
};

// A child process. It runs in its own process group, so that Ctrl-C at the terminal reaches only this process. When
// it ends, so do all its descendants, even those that left the group: this process becomes a subreaper (prctl), so
// they are found. It also ends with the thread that started it (PR_SET_PDEATHSIG). Several threads may each have a
// child.
class Child {
public:
    // Throws InputError if its scratch folder cannot be made, std::runtime_error if the process cannot be started.
    explicit Child(Launch launch);
    ~Child();  // kills it if it still runs
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    enum class Heard { line, nothing, closed };

    // Waits up to `wait` for the next line of its events. `closed`: the other end of the pipe is closed, or the child
    // has ended; its descendants, which may have held the pipe open, have then ended, too.
    Heard listen(std::chrono::milliseconds wait, std::string& line);

    // Waits for the child to end, and kills it at a limit or at a deferred interrupt (interrupts.h).
    enum class End { by_itself, time, memory, interrupt };
    End wait(const ChildLimits& limits);
    bool ended_within(std::chrono::milliseconds wait);

    void kill();  // the process and its descendants

    // Waits for the child to end and says how it did: "" for exit code 0, otherwise "signal 11 (Segmentation fault)"
    // or "exit code 3".
    std::string how_it_ended();
    std::optional<int> signal() const;  // once it has ended
    int exit_code() const;              // likewise

    // Returns whether the child and its descendants together use more memory. A page that several of them share, as
    // after a fork, counts once.
    bool takes_more_than(std::int64_t bytes) const;

    // Returns the peak resident set of the largest of its processes, in bytes, once it has ended. -1 if that is not
    // clearly above the resident set of this process when it started the child, which the kernel includes.
    std::int64_t peak_bytes() const { return peak_bytes_; }

    // Returns the end of its output.
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
    std::size_t fed_ = 0;        // bytes of its input written so far; it may read slowly, or never
    std::string buffer_, said_;  // events not yet returned; the end of its output
    // This process and its earlier descendants, which are spared; so are other living children.
    std::vector<pid_t> before_;
    std::int64_t own_bytes_ = 0, peak_bytes_ = -1;
    std::optional<int> status_;
};

}  // namespace hausbench
