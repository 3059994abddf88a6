#include "process/child.h"

#include "process/family.h"
#include "process/interrupts.h"
#include "process/memory.h"
#include "process/watch.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <stdexcept>
#include <string_view>

namespace hausbench {

std::string shell_quoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::size_t longest_line = std::size_t(1) << 28;  // bytes; a longer line means that the child is broken
constexpr milliseconds between_looks_at_memory(20);

// Writes as much as fits into the pipe now. Returns the number of bytes written, or -1 if the reader has closed the
// pipe. Blocks SIGPIPE, which would then end this process, only during the write and only in this thread: it must still
// end `hausbench show ... | head`.
ssize_t write_some(int descriptor, std::string_view text) {
    sigset_t pipe, before;
    sigemptyset(&pipe);
    sigaddset(&pipe, SIGPIPE);
    ::pthread_sigmask(SIG_BLOCK, &pipe, &before);
    ssize_t done = ::write(descriptor, text.data(), text.size());
    if (done < 0 && (errno == EINTR || errno == EAGAIN)) done = 0;
    const timespec none{};
    if (!sigismember(&before, SIGPIPE)) ::sigtimedwait(&pipe, nullptr, &none);  // removes a pending SIGPIPE
    ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
    return done;
}

// The living children of all threads. The lock is held while a child is started, and while the descendants of an ended
// child are killed, so that a child that another thread has just started is not killed with them.
std::mutex living_lock;
std::vector<pid_t> living;

// Restricts the calling process to these cores; called in the child, right after fork().
void run_on(const std::vector<int>& cores) {
    if (cores.empty()) return;
    cpu_set_t set;
    CPU_ZERO(&set);
    for (const int core : cores) CPU_SET(core, &set);
    ::sched_setaffinity(0, sizeof set, &set);
}

// Returns the environment of this process, with TMPDIR set to `temporary`.
std::vector<std::string> environment_with(const std::string& temporary) {
    std::vector<std::string> all{"TMPDIR=" + temporary};
    for (char** entry = environ; *entry; ++entry) {
        if (std::strncmp(*entry, "TMPDIR=", 7) != 0) all.emplace_back(*entry);
    }
    return all;
}

// Returns pointers to the strings, then a null pointer, as execve() requires.
std::vector<char*> pointers_to(std::vector<std::string>& texts) {
    std::vector<char*> all;
    for (std::string& text : texts) all.push_back(text.data());
    all.push_back(nullptr);
    return all;
}

}  // namespace

struct Child::Pipes {
    int feed[2], events[2], output[2];

    Pipes() {
        if (::pipe2(feed, O_CLOEXEC) != 0 || ::pipe2(events, O_CLOEXEC) != 0 || ::pipe2(output, O_CLOEXEC) != 0)
            throw std::runtime_error(fmt::format("cannot open a pipe: {}", std::strerror(errno)));
    }
};

// Forks a process that calls `child`. If `child` returns, the program could not be run, and the exit code is 127.
// Except for Launch::work, `child` may make only calls that are safe after a program with several threads has forked.
void Child::start(Pipes& pipes, const std::function<void()>& child) {
    ::prctl(PR_SET_CHILD_SUBREAPER, 1);
    if (launch_.dies_with_parent) watch_group(0);  // starts its shell, which then is in `before_` and not killed
    own_bytes_ = resident_of(::getpid());
    const pid_t parent = ::getpid();
    std::unique_lock lock(living_lock);
    before_ = family_of(parent);
    pid_ = ::fork();
    if (pid_ > 0) living.push_back(pid_);
    lock.unlock();  // in the child, too: a copy that works may have children of its own
    if (pid_ == 0) {
        ::setpgid(0, 0);
        run_on(launch_.cores);
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // its orphans become its children, so family_of() finds them
        if (::getppid() != parent) ::_exit(127);
        ::dup2(pipes.feed[0], STDIN_FILENO);
        child();
        ::_exit(127);
    }
    const int error = errno;
    for (const int end : {pipes.feed[0], pipes.events[1], pipes.output[1]}) ::close(end);
    events_ = pipes.events[0];
    output_ = pipes.output[0];
    ::fcntl(output_, F_SETFL, O_NONBLOCK);
    if (pid_ > 0) {
        ::setpgid(pid_, pid_);  // both processes call this, as either may run first
        if (launch_.dies_with_parent) watch_group(pid_);
        input_ = pipes.feed[1];
        ::fcntl(input_, F_SETFL, O_NONBLOCK);
        feed();
        return;
    }
    ::close(pipes.feed[1]);
    ::close(events_);
    ::close(output_);
    throw std::runtime_error(fmt::format("cannot start a process: {}", std::strerror(error)));
}

Child::Child(Launch launch) : launch_(std::move(launch)) {
    if (!launch_.scratch.empty()) folder_.emplace(launch_.scratch);
    const std::string temporary = folder_ ? folder_->path().string() : "";
    Pipes pipes;
    if (launch_.work) {
        std::fflush(nullptr);  // otherwise the copy would write buffered output a second time
        start(pipes, [&] {
            for (const int end : {pipes.feed[1], pipes.events[0], pipes.output[0]}) ::close(end);
            ::dup2(launch_.silent ? pipes.output[1] : STDERR_FILENO, STDOUT_FILENO);
            if (launch_.silent) ::dup2(pipes.output[1], STDERR_FILENO);
            if (folder_) ::setenv("TMPDIR", temporary.c_str(), 1);
            const int code = launch_.work(pipes.events[1]);
            std::fflush(nullptr);
            ::_exit(code);
        });
        return;
    }
    std::vector<std::string> words = launch_.command, environment;
    if (folder_) environment = environment_with(temporary);
    if (launch_.events) words.push_back(fmt::format("{}", pipes.events[1]));
    const std::vector<char*> arguments = pointers_to(words), entries = pointers_to(environment);
    char* const* variables = folder_ ? entries.data() : environ;
    start(pipes, [&] {
        if (!launch_.folder.empty() && ::chdir(launch_.folder.c_str()) != 0) ::_exit(127);
        ::dup2(launch_.silent ? ::open("/dev/null", O_WRONLY) : pipes.output[1], STDOUT_FILENO);
        ::dup2(pipes.output[1], STDERR_FILENO);
        if (launch_.events) ::fcntl(pipes.events[1], F_SETFD, 0);  // keeps it open in the program
        ::signal(SIGPIPE, SIG_DFL);
        sigset_t none;  // unblocks the signals that end_family_with_parent() blocks in a worker
        sigemptyset(&none);
        ::sigprocmask(SIG_SETMASK, &none, nullptr);
        ::execve(arguments[0], arguments.data(), variables);
    });
}

// Writes as much of Launch::input as fits into the pipe now. Closes the pipe after the last byte, unless more may follow.
void Child::feed() {
    while (input_ >= 0) {
        const std::string_view rest = std::string_view(launch_.input).substr(fed_);
        if (rest.empty() && launch_.more_input) return;
        const ssize_t written = rest.empty() ? -1 : write_some(input_, rest);
        if (written == 0) return;  // the pipe is full
        if (written > 0) {
            fed_ += std::size_t(written);
            continue;
        }
        ::close(input_);  // everything is written, or the child has closed the pipe; wait() tells whether it has ended
        input_ = -1;
    }
}

void Child::write(std::string input) {
    read_output();
    said_.clear();
    launch_.input = std::move(input);
    fed_ = 0;
    feed();
}

Child::~Child() {
    kill();
    look_for_end(0);
    if (input_ >= 0) ::close(input_);
    ::close(events_);
    if (output_ >= 0) ::close(output_);
}

// Reads all available output, so that the child never waits for room in the pipe, and keeps only the end. Sets
// `output_` to -1 when nothing can follow.
void Child::read_output() {
    char bytes[1 << 16];
    while (output_ >= 0) {
        const ssize_t n = ::read(output_, bytes, sizeof bytes);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0 && errno == EAGAIN) break;
        if (n <= 0) {
            ::close(output_);
            output_ = -1;
            break;
        }
        said_.append(bytes, std::size_t(n));
        if (said_.size() > 2 * launch_.kept + sizeof bytes) said_.erase(0, said_.size() - launch_.kept);
    }
}

const std::string& Child::output() {
    read_output();
    if (said_.size() > launch_.kept) said_.erase(0, said_.size() - launch_.kept);
    return said_;
}

Child::Heard Child::listen(milliseconds wait, std::string& line) {
    const auto deadline = steady_clock::now() + wait;
    std::size_t searched = 0;
    for (;;) {
        if (const std::size_t end = buffer_.find('\n', searched); end != std::string::npos) {
            line = buffer_.substr(0, end);
            buffer_.erase(0, end + 1);
            return Heard::line;
        }
        searched = buffer_.size();
        const auto left = std::chrono::ceil<milliseconds>(deadline - steady_clock::now());
        const int hungry = fed_ < launch_.input.size() ? input_ : -1;  // the pipe, if there is input to write
        pollfd on[3] = {{events_, POLLIN, 0}, {output_, POLLIN, 0}, {hungry, POLLOUT, 0}};
        const int ready = ::poll(on, 3, int(std::max<std::int64_t>(0, left.count())));
        if (on[1].revents) read_output();
        if (on[2].revents) feed();
        if (!on[0].revents) {
            if (ready > 0 && left.count() > 0) continue;
            if (status_) return Heard::closed;
            // Kills a descendant that holds the pipe open after the child has ended.
            look_for_end(WNOHANG);
            return Heard::nothing;  // lets the caller check for interrupts
        }
        char bytes[1 << 16];
        const ssize_t n = ::read(events_, bytes, sizeof bytes);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0 || buffer_.size() > longest_line) return Heard::closed;
        buffer_.append(bytes, std::size_t(n));
    }
}

Child::End Child::wait(const ChildLimits& limits) {
    const auto begin = steady_clock::now();
    auto next_look = begin;
    End end = End::by_itself;
    while (!status_) {
        if (end == End::by_itself) {
            const auto now = steady_clock::now();
            if (HoldInterrupts::came()) end = End::interrupt;
            if (std::chrono::duration<double>(now - begin).count() >= limits.seconds) end = End::time;
            if (limits.resident_bytes < std::numeric_limits<std::int64_t>::max() && now >= next_look) {
                if (takes_more_than(limits.resident_bytes)) end = End::memory;
                next_look = now + between_looks_at_memory;
            }
            if (end != End::by_itself) kill();
            if (limits.waiting) limits.waiting();
        }
        ended_within(milliseconds(1));
    }
    return end;
}

// Notices the end of the child within a millisecond, or at once if the child was the last to hold the output pipe open.
bool Child::ended_within(milliseconds wait) {
    const auto deadline = steady_clock::now() + wait;
    for (;;) {
        look_for_end(WNOHANG);
        if (status_ || steady_clock::now() >= deadline) return bool(status_);
        pollfd on{output_, POLLIN, 0};
        ::poll(&on, 1, 1);
        read_output();
        feed();
    }
}

// Checks whether the child has ended; unless `flags` has WNOHANG, waits for its end. If the child has ended, kills the
// descendants that it left behind.
void Child::look_for_end(int flags) {
    if (status_) return;
    int status = 0;
    rusage used{};
    pid_t ended;
    do ended = ::wait4(pid_, &status, flags, &used);
    while (ended < 0 && errno == EINTR);
    if (ended == 0) return;
    status_ = ended < 0 ? 0 : status;
    const std::int64_t peak = std::int64_t(used.ru_maxrss) * 1024;
    if (peak > own_bytes_ + (1 << 20)) peak_bytes_ = peak;
    if (launch_.dies_with_parent) watch_group(0);
    ::kill(-pid_, SIGKILL);  // the rest of its group
    {
        const std::lock_guard lock(living_lock);  // then descendants that left the group
        std::erase(living, pid_);
        std::vector<pid_t> spared = before_;
        spared.insert(spared.end(), living.begin(), living.end());
        end_family(spared);
    }
    read_output();  // the last output; the pipe may still be open
}

void Child::kill() {
    if (status_) return;
    const std::vector<pid_t> family = family_of(pid_);
    ::kill(-pid_, SIGKILL);                                     // its process group
    for (const pid_t member : family) ::kill(member, SIGKILL);  // also the child, whose group may not exist yet
}

std::string Child::how_it_ended() {
    look_for_end(0);
    if (const auto number = signal()) return fmt::format("signal {} ({})", *number, ::strsignal(*number));
    return exit_code() == 0 ? "" : fmt::format("exit code {}", exit_code());
}

std::optional<int> Child::signal() const {
    return status_ && WIFSIGNALED(*status_) ? std::optional<int>(WTERMSIG(*status_)) : std::nullopt;
}

int Child::exit_code() const { return status_ ? WEXITSTATUS(*status_) : 0; }

bool Child::takes_more_than(std::int64_t bytes) const {
    const std::vector<pid_t> family = family_of(pid_);
    const auto sum = [&](std::int64_t (*of)(pid_t)) {
        std::int64_t all = 0;
        for (const pid_t member : family) all += of(member);
        return all;
    };
    // The sum of the resident sets is cheap, exact for one process, and never less than the sum of the proportional
    // sets (memory.h). So the proportional sets are read only if several processes together exceed the limit.
    return sum(resident_of) > bytes && (family.size() == 1 || sum(proportional_bytes_of) > bytes);
}

std::string Child::last_words(std::size_t characters) {
    const std::string& said = output();
    std::string text = said.substr(said.size() - std::min(said.size(), characters));
    for (char& c : text) {
        if (c == '\n')
            c = ' ';
        else if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126)
            c = '?';  // not printable ASCII
    }
    const auto begin = text.find_first_not_of(' ');
    const auto last = text.find_last_not_of(' ');
    return begin == std::string::npos ? "" : text.substr(begin, last - begin + 1);
}

}  // namespace hausbench
