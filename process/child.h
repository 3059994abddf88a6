// Starts a child process, reads its output, limits its time and memory, and ends it with all its descendants.
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

// Quotes text so that a shell reads it as one word.
std::string shell_quoted(const std::string& text);

// How to start a child process. Set either `command`, to run a program, or `work`, to run a function.
struct Launch {
    std::vector<std::string> command;  // path of the program, then its arguments

    // Function to run in a copy of this process (fork). Its argument is the descriptor of a pipe for events (see
    // Child::listen); its result is the exit code of the copy. This process must have one thread only.
    std::function<int(int events)> work;

    std::filesystem::path folder;  // working folder of the program; empty: the current one
    std::string input;             // written to standard input of the child; empty: none
    bool more_input = false;       // keeps standard input open after `input`, for Child::write()
    bool events = false;           // adds the descriptor of the pipe for events to the arguments of the program
    // For a program: discards its standard output and keeps only its standard error. For `work`: keeps both, instead of
    // passing them to the standard error of this process.
    bool silent = false;
    std::size_t kept = 4096;  // how many characters to keep of the end of the child's output
    std::string scratch;      // makes a ScratchFolder of this kind and sets the child's TMPDIR to it; empty: none
    // Kills the child and its process group when this process ends, even by SIGKILL. At most one child at a time can
    // have this.
    bool dies_with_parent = false;
    std::vector<int> cores;  // cores that the child may run on, by the kernel's numbers; empty: as this process
};

// Limits at which Child::wait() kills the child, and what it does meanwhile.
struct ChildLimits {
    double seconds = std::numeric_limits<double>::infinity();                // wall time from the call of wait()
    std::int64_t resident_bytes = std::numeric_limits<std::int64_t>::max();  // of the child and its descendants
    std::function<void()> waiting = {};  // called every few milliseconds; may be empty
};

// A child process. It has its own process group, so that Ctrl-C at the terminal reaches only this process. When the
// child ends, all its descendants are killed, even those that left the group: this process becomes a subreaper (prctl),
// which inherits orphaned descendants and can therefore find them. The child is also killed when the thread that
// started it ends (PR_SET_PDEATHSIG). Several threads may each have a child.
class Child {
public:
    // Starts the child. Throws InputError if the scratch folder cannot be made, and std::runtime_error if the process
    // cannot be started. If the program does not exist or cannot run, the child ends with exit code 127.
    explicit Child(Launch launch);
    ~Child();  // kills the child if it still runs
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    enum class Heard { line, nothing, closed };

    // Waits up to `wait` for an event: a line that the child writes to the pipe for events. Returns
    // - `line`, with the text in `line`;
    // - `nothing` if no complete line has arrived yet;
    // - `closed` if no line can follow: every copy of the child's end of the pipe is closed, the child has ended, or it
    //   wrote a line that is too long. Descendants that held the pipe open after the child's end were killed.
    Heard listen(std::chrono::milliseconds wait, std::string& line);

    // Waits for the child to end, and returns why it ended. Kills it if it exceeds a limit, or if an interrupt arrives
    // that HoldInterrupts defers (interrupts.h).
    enum class End { by_itself, time, memory, interrupt };
    End wait(const ChildLimits& limits);
    bool ended_within(std::chrono::milliseconds wait);  // waits up to `wait`

    // Sends more input to a child with Launch::more_input that has read all input so far. Forgets its output so far.
    void write(std::string input);

    void kill();  // kills the child and its descendants, without waiting for their end

    // Waits for the child to end and describes how it ended: "signal 11 (Segmentation fault)" or "exit code 3". Returns
    // an empty string for exit code 0.
    std::string how_it_ended();
    std::optional<int> signal() const;  // the signal that ended the child, if one did; call it after the end
    int exit_code() const;              // call it after the end

    // Returns whether the child and its descendants together use more memory than this. A page that several of them
    // share, as after a fork, counts once.
    bool takes_more_than(std::int64_t bytes) const;

    // Returns the peak resident set, in bytes, of the child or its largest descendant. The kernel includes the time
    // between fork and exec, when the child is a copy of this process. So the result is -1 if the peak is not clearly
    // above the size of this process. It is also -1 before the child has ended.
    std::int64_t peak_bytes() const { return peak_bytes_; }

    // Returns the last Launch::kept characters of the output so far.
    const std::string& output();
    std::string last_words(std::size_t characters = 400);  // the end of the output on one line, in printable ASCII

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
    std::size_t fed_ = 0;        // bytes of Launch::input written so far; the child may read slowly, or never
    std::string buffer_, said_;  // events that listen() has not returned yet; the end of the output
    // This process and its descendants before it started the child. They are not killed when the child ends.
    std::vector<pid_t> before_;
    // Resident set of this process when it started the child, and the result of peak_bytes().
    std::int64_t own_bytes_ = 0, peak_bytes_ = -1;
    std::optional<int> status_;  // as wait4() gives it; set once the child has ended
};

}  // namespace hausbench
