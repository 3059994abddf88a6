#include "process.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace hausbench {

namespace {

constexpr std::size_t longest_line = std::size_t(1) << 28;  // of a worker gone mad

void write_all(int descriptor, const std::string& text) {
    for (std::size_t done = 0; done < text.size();) {
        const ssize_t n = ::write(descriptor, text.data() + done, text.size() - done);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return;  // it ended early: listen() will tell
        done += std::size_t(n);
    }
}

}  // namespace

WorkerProcess::WorkerProcess(const std::filesystem::path& program, const std::string& input) {
    std::signal(SIGPIPE, SIG_IGN);
    int feed[2], events[2];
    if (::pipe2(feed, O_CLOEXEC) != 0 || ::pipe2(events, O_CLOEXEC) != 0) throw std::runtime_error("cannot open a pipe");
    output_ = ::memfd_create("worker output", MFD_CLOEXEC);
    const std::string path = program.string(), descriptor = fmt::format("{}", events[1]);
    const pid_t parent = ::getpid();
    pid_ = ::fork();
    if (pid_ < 0) throw std::runtime_error(fmt::format("cannot start a worker: {}", std::strerror(errno)));
    if (pid_ == 0) {
        ::setpgid(0, 0);
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (::getppid() != parent) ::_exit(127);
        ::dup2(feed[0], STDIN_FILENO);
        ::dup2(output_, STDOUT_FILENO);
        ::dup2(output_, STDERR_FILENO);
        ::fcntl(events[1], F_SETFD, 0);  // inherited
        ::execl(path.c_str(), path.c_str(), "worker", "--events", descriptor.c_str(), static_cast<char*>(nullptr));
        ::_exit(127);
    }
    ::close(feed[0]);
    ::close(events[1]);
    events_ = events[0];
    write_all(feed[1], input);
    ::close(feed[1]);
}

WorkerProcess::~WorkerProcess() {
    kill();
    end();
    ::close(events_);
    ::close(output_);
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
        pollfd on{events_, POLLIN, 0};
        const int ready = ::poll(&on, 1, int(std::max<std::int64_t>(0, left.count())));
        if (ready <= 0) return Heard::nothing;  // an interrupt is the caller's to look at
        char bytes[1 << 16];
        const ssize_t n = ::read(events_, bytes, sizeof bytes);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0 || buffer_.size() > longest_line) return Heard::closed;
        buffer_.append(bytes, std::size_t(n));
    }
}

std::int64_t WorkerProcess::resident_bytes() const {
    std::ifstream in(fmt::format("/proc/{}/statm", pid_));
    std::int64_t size = 0, resident = 0;
    in >> size >> resident;
    return resident * ::sysconf(_SC_PAGE_SIZE);
}

void WorkerProcess::kill() {
    if (!status_) ::kill(-pid_, SIGKILL), ::kill(pid_, SIGKILL);  // the group; itself, if it has not made one yet
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

std::string WorkerProcess::last_words(std::size_t characters) const {
    const off_t size = ::lseek(output_, 0, SEEK_END);
    const off_t from = std::max<off_t>(0, size - off_t(characters));
    std::string text(std::size_t(size - from), '\0');
    const ssize_t n = ::pread(output_, text.data(), text.size(), from);
    text.resize(std::size_t(std::max<ssize_t>(0, n)));
    for (char& c : text) {
        if (c == '\n') c = ' ';
        else if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) c = '?';  // it may not be text
    }
    const auto begin = text.find_first_not_of(' ');
    const auto last = text.find_last_not_of(' ');
    return begin == std::string::npos ? "" : text.substr(begin, last - begin + 1);
}

}  // namespace hausbench
