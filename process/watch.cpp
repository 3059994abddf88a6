#include "process/watch.h"

#include "process/family.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <thread>

namespace hausbench {

namespace {

// The shell kills the last group written to its input when the input ends, as it does with this process. Returns the descriptor of the
// input; -1 on failure.
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

}  // namespace

void watch_group(pid_t group) {
    static const int watch = start_watch();
    const std::string line = group ? fmt::format("{}\n", group) : "\n";
    if (watch >= 0) static_cast<void>(::send(watch, line.data(), line.size(), MSG_NOSIGNAL));
}

void end_family_with_parent() {
    const pid_t parent = ::getppid();
    const int parent_ended = SIGRTMIN + 1;
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, parent_ended);
    sigaddset(&signals, SIGHUP);  // sent, with SIGCONT, if this process is stopped when its parent ends
    ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    std::thread([=] {
        for (;;) {
            int signal = 0;
            ::sigwait(&signals, &signal);
            if (::getppid() == parent) continue;
            end_family({});
            ::kill(::getpid(), SIGKILL);
        }
    }).detach();
    ::prctl(PR_SET_PDEATHSIG, parent_ended);
    if (::getppid() != parent) ::raise(parent_ended);  // it ended meanwhile
}

}  // namespace hausbench
