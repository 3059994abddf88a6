#include "process.h"

#include "peers/family.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace hausbench {

namespace {

constexpr std::size_t output_kept = 4096;
constexpr std::size_t longest_line = std::size_t(1) << 28;  // a longer line means that the worker is broken

void write_all(int descriptor, const std::string& text) {
    for (std::size_t done = 0; done < text.size();) {
        const ssize_t n = ::write(descriptor, text.data() + done, text.size() - done);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return;  // it ended early: listen() reports this
        done += std::size_t(n);
    }
}

// The environment without TMPDIR.
std::vector<std::string> environment_with(const std::string& folder) {
    std::vector<std::string> all{"TMPDIR=" + folder};
    for (char** entry = environ; *entry; ++entry) {
        if (std::strncmp(*entry, "TMPDIR=", 7) != 0) all.emplace_back(*entry);
    }
    return all;
}

}  // namespace

struct WorkerProcess::Pipes {
    int feed[2], events[2], output[2];

    Pipes() {
        std::signal(SIGPIPE, SIG_IGN);
        if (::pipe2(feed, O_CLOEXEC) != 0 || ::pipe2(events, O_CLOEXEC) != 0 || ::pipe2(output, O_CLOEXEC) != 0)
            throw std::runtime_error("cannot open a pipe");
    }
};

// In a process group of its own; it and its descendants end with this process. `child` does not return.
void WorkerProcess::start(Pipes& pipes, const std::function<void()>& child) {
    ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // orphans of a worker become children of this process, so they are found
    const pid_t parent = ::getpid();
    before_ = family_of(parent);
    pid_ = ::fork();
    if (pid_ < 0) throw std::runtime_error(fmt::format("cannot start a worker: {}", std::strerror(errno)));
    if (pid_ == 0) {
        ::setpgid(0, 0);
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // its orphans become its children, and count as its own
        if (::getppid() != parent) ::_exit(127);
        ::dup2(pipes.feed[0], STDIN_FILENO);
        child();
        ::_exit(127);
    }
    ::close(pipes.feed[0]);
    ::close(pipes.events[1]);
    ::close(pipes.output[1]);
    events_ = pipes.events[0];
    output_ = pipes.output[0];
    ::fcntl(output_, F_SETFL, O_NONBLOCK);
}

WorkerProcess::WorkerProcess(const std::filesystem::path& program, const std::string& input) : folder_("worker") {
    Pipes pipes;
    std::vector<std::string> environment = environment_with(folder_.path().string());
    std::vector<char*> entries;
    for (std::string& entry : environment) entries.push_back(entry.data());
    entries.push_back(nullptr);
    std::string path = program.string(), verb = "worker", option = "--events",
                descriptor = fmt::format("{}", pipes.events[1]);
    char* arguments[] = {path.data(), verb.data(), option.data(), descriptor.data(), nullptr};
    start(pipes, [&] {
        ::dup2(pipes.output[1], STDOUT_FILENO);
        ::dup2(pipes.output[1], STDERR_FILENO);
        ::fcntl(pipes.events[1], F_SETFD, 0);  // inherited
        ::execve(path.c_str(), arguments, entries.data());
    });
    write_all(pipes.feed[1], input);
    ::close(pipes.feed[1]);
}

WorkerProcess::WorkerProcess(const std::function<void(int events)>& work) : folder_("worker") {
    Pipes pipes;
    std::fflush(nullptr);  // or the copy would write it once more
    start(pipes, [&] {
        ::close(pipes.feed[1]);
        ::close(pipes.events[0]);
        ::dup2(STDERR_FILENO, STDOUT_FILENO);
        ::setenv("TMPDIR", folder_.path().c_str(), 1);
        work(pipes.events[1]);
        std::fflush(nullptr);
        ::_exit(0);
    });
    ::close(pipes.feed[1]);
}

WorkerProcess::~WorkerProcess() {
    kill();
    end();
    end_family(before_);
    ::close(events_);
    ::close(output_);
}

// Reads all output, so that the worker never blocks, and keeps only the end.
void WorkerProcess::read_output() {
    char bytes[1 << 16];
    for (;;) {
        const ssize_t n = ::read(output_, bytes, sizeof bytes);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return;
        said_.append(bytes, std::size_t(n));
        if (said_.size() > output_kept) said_.erase(0, said_.size() - output_kept);
        if (n < ssize_t(sizeof bytes)) return;
    }
}

WorkerProcess::Heard WorkerProcess::listen(std::chrono::milliseconds wait, std::string& line) {
    const auto deadline = std::chrono::steady_clock::now() + wait;
    std::size_t searched = 0;
    for (;;) {
        if (const std::size_t end = buffer_.find('\n', searched); end != std::string::npos) {
            line = buffer_.substr(0, end);
            buffer_.erase(0, end + 1);
            return Heard::line;
        }
        searched = buffer_.size();
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
        pollfd on[2] = {{events_, POLLIN, 0}, {output_open_ ? output_ : -1, POLLIN, 0}};
        const int ready = ::poll(on, 2, int(std::max<std::int64_t>(0, left.count())));
        if (ready <= 0) return Heard::nothing;  // the caller checks for interrupts
        if (on[1].revents & POLLIN)
            read_output();
        else if (on[1].revents)
            output_open_ = false;
        if (!on[0].revents) {
            if (left.count() <= 0) return Heard::nothing;
            continue;
        }
        char bytes[1 << 16];
        const ssize_t n = ::read(events_, bytes, sizeof bytes);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0 || buffer_.size() > longest_line) return Heard::closed;
        buffer_.append(bytes, std::size_t(n));
    }
}

std::int64_t WorkerProcess::resident_bytes() const {
    std::int64_t all = 0;
    for (const pid_t member : family_of(pid_)) {
        std::ifstream in(fmt::format("/proc/{}/statm", member));
        std::int64_t size = 0, resident = 0;
        in >> size >> resident;
        all += resident;
    }
    return all * ::sysconf(_SC_PAGE_SIZE);
}

void WorkerProcess::kill() {
    if (status_) return;
    const std::vector<pid_t> family = family_of(pid_);
    ::kill(-pid_, SIGKILL);                                     // its process group
    for (const pid_t member : family) ::kill(member, SIGKILL);  // the worker first: its group may not exist yet
}

bool WorkerProcess::ended_within(std::chrono::milliseconds wait) {
    const auto deadline = std::chrono::steady_clock::now() + wait;
    while (!status_) {
        int status = 0;
        if (::waitpid(pid_, &status, WNOHANG) == pid_)
            status_ = status;
        else if (std::chrono::steady_clock::now() > deadline)
            return false;
        else
            ::poll(nullptr, 0, 5);
        read_output();
    }
    return true;
}

std::string WorkerProcess::end() {
    if (!status_) {
        int status = 0;
        while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
        }
        status_ = status;
    }
    if (WIFSIGNALED(*status_)) return fmt::format("signal {} ({})", WTERMSIG(*status_), strsignal(WTERMSIG(*status_)));
    if (WEXITSTATUS(*status_) != 0) return fmt::format("exit code {}", WEXITSTATUS(*status_));
    return "";
}

std::optional<int> WorkerProcess::signal() const {
    if (status_ && WIFSIGNALED(*status_)) return WTERMSIG(*status_);
    return std::nullopt;
}

std::string WorkerProcess::last_words(std::size_t characters) {
    read_output();
    std::string text = said_.substr(said_.size() - std::min(said_.size(), characters));
    for (char& c : text) {
        if (c == '\n')
            c = ' ';
        else if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126)
            c = '?';  // a byte that is no text
    }
    const auto begin = text.find_first_not_of(' ');
    const auto last = text.find_last_not_of(' ');
    return begin == std::string::npos ? "" : text.substr(begin, last - begin + 1);
}

}  // namespace hausbench
