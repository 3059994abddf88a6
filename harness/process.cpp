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
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace hausbench {

namespace {

constexpr std::size_t output_kept = 4096;
constexpr std::size_t longest_line = std::size_t(1) << 28;  // of a worker gone mad

void write_all(int descriptor, const std::string& text) {
    for (std::size_t done = 0; done < text.size();) {
        const ssize_t n = ::write(descriptor, text.data() + done, text.size() - done);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return;  // it ended early: listen() will tell
        done += std::size_t(n);
    }
}

// The environment, but for TMPDIR.
std::vector<std::string> environment_with(const std::string& folder) {
    std::vector<std::string> all{"TMPDIR=" + folder};
    for (char** entry = environ; *entry; ++entry) {
        if (std::strncmp(*entry, "TMPDIR=", 7) != 0) all.emplace_back(*entry);
    }
    return all;
}

}  // namespace

WorkerProcess::WorkerProcess(const std::filesystem::path& program, const std::string& input) : folder_("worker") {
    ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // what a worker leaves behind becomes this process's child, and is found
    std::signal(SIGPIPE, SIG_IGN);
    int feed[2], events[2], output[2];
    if (::pipe2(feed, O_CLOEXEC) != 0 || ::pipe2(events, O_CLOEXEC) != 0 || ::pipe2(output, O_CLOEXEC) != 0) {
        throw std::runtime_error("cannot open a pipe");
    }
    std::vector<std::string> environment = environment_with(folder_.path().string());
    std::vector<char*> entries;
    for (std::string& entry : environment) entries.push_back(entry.data());
    entries.push_back(nullptr);
    std::string path = program.string(), verb = "worker", option = "--events",
                descriptor = fmt::format("{}", events[1]);
    char* arguments[] = {path.data(), verb.data(), option.data(), descriptor.data(), nullptr};
    const pid_t parent = ::getpid();
    before_ = family_of(parent);
    pid_ = ::fork();
    if (pid_ < 0) throw std::runtime_error(fmt::format("cannot start a worker: {}", std::strerror(errno)));
    if (pid_ == 0) {
        ::setpgid(0, 0);
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // so that what it starts hangs on it, and counts
        if (::getppid() != parent) ::_exit(127);
        ::dup2(feed[0], STDIN_FILENO);
        ::dup2(output[1], STDOUT_FILENO);
        ::dup2(output[1], STDERR_FILENO);
        ::fcntl(events[1], F_SETFD, 0);  // inherited
        ::execve(path.c_str(), arguments, entries.data());
        ::_exit(127);
    }
    ::close(feed[0]);
    ::close(events[1]);
    ::close(output[1]);
    events_ = events[0];
    output_ = output[0];
    ::fcntl(output_, F_SETFL, O_NONBLOCK);
    write_all(feed[1], input);
    ::close(feed[1]);
}

WorkerProcess::~WorkerProcess() {
    kill();
    end();
    end_family(before_);
    ::close(events_);
    ::close(output_);
}

// So that a worker that writes much is not held up, and only the end of it is kept.
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
        if (ready <= 0) return Heard::nothing;  // an interrupt is the caller's to look at
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
    ::kill(-pid_, SIGKILL);                                     // its group, whoever is in it
    for (const pid_t member : family) ::kill(member, SIGKILL);  // first itself, which may have made no group yet
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
            c = '?';  // it may not be text
    }
    const auto begin = text.find_first_not_of(' ');
    const auto last = text.find_last_not_of(' ');
    return begin == std::string::npos ? "" : text.substr(begin, last - begin + 1);
}

}  // namespace hausbench
