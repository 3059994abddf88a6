#include "process/watch.h"

#include "process/family.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <future>
#include <string>
#include <thread>
#include <utility>

namespace hausbench {

namespace {

// Starts a shell that reads numbers of process groups from its input, one per line. The input ends when this process
// ends; the shell then kills the group that it read last. Returns the descriptor for writing to the shell, or -1 on
// failure.
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

// Waits, for at most a second, until a new thread of this process sleeps. On a busy machine, the thread could otherwise
// still be starting during a timed solve, which would then seem to use two threads.
void wait_until_asleep(pid_t thread) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(1);
    while (std::chrono::steady_clock::now() < end) {
        std::ifstream in(fmt::format("/proc/self/task/{}/stat", thread));
        std::string line;
        std::getline(in, line);
        const std::size_t name_ends = line.rfind(')');  // "7 (name) S ...": the name may contain anything
        if (name_ends == std::string::npos || line.compare(name_ends, 3, ") S") == 0) return;
        ::sched_yield();
    }
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
    sigaddset(&signals, SIGHUP);  // the kernel sends it, with SIGCONT, to a stopped process whose parent ends
    ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    std::promise<pid_t> start;
    std::future<pid_t> started = start.get_future();
    std::thread([start = std::move(start), parent, signals]() mutable {
        start.set_value(::gettid());
        for (;;) {
            int signal = 0;
            ::sigwait(&signals, &signal);
            if (::getppid() == parent) continue;
            end_family({});
            ::kill(::getpid(), SIGKILL);
        }
    }).detach();
    ::prctl(PR_SET_PDEATHSIG, parent_ended);
    if (::getppid() != parent) ::raise(parent_ended);  // the parent ended before prctl()
    wait_until_asleep(started.get());
}

}  // namespace hausbench
