#include "process/stand_in.h"

#include "algorithms/error.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <stdexcept>

namespace hausbench {
namespace {

using std::chrono::steady_clock;

constexpr std::array<int, 4> passed_on = {SIGINT, SIGTERM, SIGHUP, SIGQUIT};
constexpr std::chrono::seconds time_to_end(2);  // for destructors of static objects, after all work is done

int to_waiting = -1;  // in the copy: pipe to the process that waits
volatile std::sig_atomic_t signal_to_pass = 0;

// Messages are lines: "limit SECONDS DOING", "no limit" and "code N".
void tell(std::string line) {
    if (to_waiting < 0) return;
    line += '\n';
    for (std::size_t done = 0; done < line.size();) {
        const ssize_t n = ::write(to_waiting, line.data() + done, line.size() - done);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return;
        done += static_cast<std::size_t>(n);
    }
}

// The process that waits for its copy.
class Waiting {
public:
    Waiting(pid_t copy, int pipe, std::string blamed) : copy_(copy), pipe_(pipe), blamed_(std::move(blamed)) {
        for (std::size_t i = 0; i < passed_on.size(); ++i) {
            ::sigaction(passed_on[i], nullptr, &before_[i]);
            if (before_[i].sa_handler != SIG_DFL) continue;
            struct sigaction action {};
            action.sa_handler = [](int number) { signal_to_pass = number; };
            ::sigaction(passed_on[i], &action, nullptr);
        }
    }

    // Returns the exit code of the copy, or throws.
    int run() {
        while (!ended()) {
            if (const int number = signal_to_pass; number != 0) {
                signal_to_pass = 0;
                passed_ = number;
                ::kill(copy_, number);
            }
            listen();
            if (deadline_ && steady_clock::now() > *deadline_) {
                ::kill(copy_, SIGKILL);
                ::waitpid(copy_, &status_, 0);
                if (code_) return *code_;
                restore();
                throw InputError(
                    fmt::format("{} did not end within {:g} s: mend the plug-in, or leave it out", doing_, seconds_));
            }
        }
        listen();
        if (code_) return *code_;
        restore();
        if (WIFSIGNALED(status_) && WTERMSIG(status_) == passed_) {
            ::raise(passed_);
            return 128 + passed_;
        }
        const std::string how = WIFSIGNALED(status_)
                                    ? fmt::format("signal {} ({})", WTERMSIG(status_), ::strsignal(WTERMSIG(status_)))
                                    : fmt::format("exit code {}", WEXITSTATUS(status_));
        throw InputError(fmt::format("{}: ended the program with {}{}: mend the plug-in, or leave it out", blamed_, how,
                                     doing_.empty() ? "" : " in " + doing_));
    }

private:
    bool ended() { return ::waitpid(copy_, &status_, WNOHANG) == copy_; }

    void restore() {
        for (std::size_t i = 0; i < passed_on.size(); ++i)
            if (before_[i].sa_handler == SIG_DFL) ::sigaction(passed_on[i], &before_[i], nullptr);
    }

    // Waits up to 20 ms for messages, and reads all that have come.
    void listen() {
        struct pollfd ready {
            pipe_, POLLIN, 0
        };
        if (::poll(&ready, 1, closed_ ? 0 : 20) <= 0 || closed_) {
            if (closed_) ::usleep(20'000);
            return;
        }
        std::array<char, 4096> some{};
        const ssize_t n = ::read(pipe_, some.data(), some.size());
        if (n == 0) closed_ = true;
        if (n <= 0) return;
        buffer_.append(some.data(), static_cast<std::size_t>(n));
        for (std::size_t end; (end = buffer_.find('\n')) != std::string::npos; buffer_.erase(0, end + 1))
            hear(buffer_.substr(0, end));
        if (buffer_.size() > 65536) buffer_.clear();  // not written by tell()
    }

    void hear(const std::string& line) {
        const auto allow = [&](double seconds) {
            seconds_ = seconds;
            deadline_ = steady_clock::now() +
                        std::chrono::duration_cast<steady_clock::duration>(std::chrono::duration<double>(seconds));
        };
        int code = 0, at = 0;
        double seconds = 0;
        if (std::sscanf(line.c_str(), "code %d", &code) == 1 && !code_) {
            code_ = code;
            allow(static_cast<double>(time_to_end.count()));
        } else if (std::sscanf(line.c_str(), "limit %lf %n", &seconds, &at) == 1 && at > 0) {
            doing_ = line.substr(static_cast<std::size_t>(at));
            allow(seconds);
        } else if (line == "no limit" && !code_) {
            doing_.clear();
            deadline_.reset();
        }
    }

    pid_t copy_;
    int pipe_;
    std::string blamed_, buffer_, doing_;
    double seconds_ = 0;
    std::optional<steady_clock::time_point> deadline_;
    std::optional<int> code_;
    bool closed_ = false;
    int status_ = 0, passed_ = 0;
    std::array<struct sigaction, passed_on.size()> before_;
};

}  // namespace

void continue_in_copy(const std::string& blamed) {
    if (to_waiting >= 0) return;
    std::array<int, 2> ends{};
    std::fflush(nullptr);
    const pid_t self = ::getpid();
    if (::pipe2(ends.data(), O_CLOEXEC) != 0)
        throw std::runtime_error(fmt::format("no pipe to a copy of this process: {}", std::strerror(errno)));
    sigset_t held, before;  // a signal that comes before Waiting can pass it on must not end this process
    sigemptyset(&held);
    for (const int number : passed_on) sigaddset(&held, number);
    ::sigprocmask(SIG_BLOCK, &held, &before);
    const pid_t copy = ::fork();
    const int error = errno;
    if (copy <= 0) ::sigprocmask(SIG_SETMASK, &before, nullptr);
    if (copy < 0) throw std::runtime_error(fmt::format("no copy of this process: {}", std::strerror(error)));
    if (copy == 0) {
        ::setpgid(0, 0);  // Ctrl-C reaches the waiting process alone, which passes it on
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (::getppid() != self) ::_exit(1);
        ::close(ends[0]);
        to_waiting = ends[1];
        return;
    }
    ::setpgid(copy, copy);
    ::close(ends[1]);
    Waiting waiting(copy, ends[0], blamed);
    ::sigprocmask(SIG_SETMASK, &before, nullptr);
    const int code = waiting.run();
    ::_exit(code);  // the copy has run all destructors that matter
}

void tell_exit_code(int code) {
    std::fflush(nullptr);
    tell(fmt::format("code {}", code));
}

TimeLimited::TimeLimited(const std::string& doing, double seconds) {
    std::string line = doing;
    for (char& c : line)
        if (c == '\n') c = ' ';
    tell(fmt::format("limit {} {}", seconds, line));
}

TimeLimited::~TimeLimited() { tell("no limit"); }

}  // namespace hausbench
