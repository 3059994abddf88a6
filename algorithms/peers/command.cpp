#include "peers/command.h"

#include "kernel/deadline.h"
#include "peers/family.h"
#include "scratch.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
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

constexpr std::size_t output_kept = std::size_t(16) << 20;

std::int64_t resident_now() {
    std::ifstream in("/proc/self/statm");
    std::int64_t size = 0, resident = 0;
    in >> size >> resident;
    return resident * ::sysconf(_SC_PAGE_SIZE);
}

// Reads the available output; false at the end of the pipe.
bool read_some(int pipe, std::string& to) {
    char bytes[1 << 16];
    for (;;) {
        const ssize_t n = ::read(pipe, bytes, sizeof bytes);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return errno == EAGAIN;
        if (n == 0) return false;
        to.append(bytes, std::size_t(n));
        if (to.size() > 2 * output_kept) to.erase(0, to.size() - output_kept);
    }
}

// Starts a shell that kills the last process group written to its input when this process ends, for whatever reason.
// Returns the descriptor of that input; -1 on failure. All commands share one shell: starting it would count in their times.
int start_watch() {
    int talk[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, talk) != 0) return -1;
    const pid_t child = ::fork();
    if (child == 0) {
        ::setpgid(0, 0);
        const int null = ::open("/dev/null", O_RDWR);
        ::dup2(talk[0], STDIN_FILENO);
        ::dup2(null, STDOUT_FILENO);
        ::dup2(null, STDERR_FILENO);
        ::execl("/bin/sh", "sh", "-c", "while read line; do group=$line; done; [ -z $group ] || kill -9 -$group",
                static_cast<char*>(nullptr));
        ::_exit(127);
    }
    ::close(talk[0]);
    return child < 0 ? -1 : talk[1];
}

// An empty text: kill nothing.
void tell(int watch, const std::string& group) {
    const std::string line = group + "\n";
    if (watch >= 0) static_cast<void>(::send(watch, line.data(), line.size(), MSG_NOSIGNAL));
}

}  // namespace

CommandRun run_command(const std::string& line, double seconds, const std::filesystem::path& folder) {
    int output[2];
    if (::pipe2(output, O_CLOEXEC) != 0) throw std::runtime_error(fmt::format("no pipe: {}", std::strerror(errno)));
    static const int watch = start_watch();
    const std::int64_t own_bytes = resident_now();
    ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // orphans of the command become children of this process, so they are found
    const pid_t parent = ::getpid();
    const std::vector<pid_t> before = family_of(parent);
    const pid_t child = ::fork();
    if (child < 0) {
        ::close(output[0]);
        ::close(output[1]);
        throw std::runtime_error(fmt::format("cannot start a process: {}", std::strerror(errno)));
    }
    if (child == 0) {
        ::setpgid(0, 0);
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (::getppid() != parent || (!folder.empty() && ::chdir(folder.c_str()) != 0)) ::_exit(127);
        ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
        ::dup2(output[1], STDOUT_FILENO);
        ::dup2(output[1], STDERR_FILENO);
        ::signal(SIGPIPE, SIG_DFL);
        ::execl("/bin/sh", "sh", "-c", line.c_str(), static_cast<char*>(nullptr));
        ::_exit(127);
    }
    ::setpgid(child, child);  // both processes call this; the order does not matter
    tell(watch, fmt::format("{}", child));
    ::close(output[1]);
    ::fcntl(output[0], F_SETFL, O_NONBLOCK);

    const Deadline deadline(seconds);
    CommandRun run;
    int status = 0;
    rusage used{};
    for (bool open = true;;) {
        pollfd on{open ? output[0] : -1, POLLIN, 0};
        ::poll(&on, 1, 1);  // notices its end within a millisecond, or at once if its output ends
        if (on.revents) open = read_some(output[0], run.output);
        const pid_t ended = ::wait4(child, &status, WNOHANG, &used);
        if (ended == child || (ended < 0 && errno != EINTR)) break;
        if (!run.timed_out && (deadline.passed() || HoldInterrupts::came())) {
            run.timed_out = true;
            ::kill(-child, SIGKILL);
        }
    }
    tell(watch, "");
    ::kill(-child, SIGKILL);  // the rest of its group
    end_family(before);       // and processes that left the group
    read_some(output[0], run.output);
    ::close(output[0]);
    if (run.output.size() > output_kept) run.output.erase(0, run.output.size() - output_kept);
    if (WIFSIGNALED(status))
        run.failure = fmt::format("signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status)));
    else if (WEXITSTATUS(status) != 0)
        run.failure = fmt::format("exit code {}", WEXITSTATUS(status));
    const std::int64_t peak = std::int64_t(used.ru_maxrss) * 1024;
    if (peak > own_bytes + (1 << 20)) run.peak_bytes = peak;
    return run;
}

}  // namespace hausbench
