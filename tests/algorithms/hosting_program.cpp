// Loads the library of algorithms into a program with signal handlers and a child process, which the library must leave
// alone.
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>

extern "C" int bound_by_all_solvers(const double* a, const double* b, int points);

namespace {

volatile std::sig_atomic_t heard = 0;

int fail(const char* why) {
    std::fprintf(stderr, "%s\n", why);
    return 1;
}

}  // namespace

int main() {
    constexpr int signals[] = {SIGINT, SIGTERM, SIGCHLD, SIGPIPE, SIGFPE};
    for (const int number : signals) std::signal(number, [](int which) { heard = which; });
    const pid_t child = ::fork();
    while (child == 0) ::pause();
    const double a[] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, b[] = {0, 0, 1, 1, 0, 1, 0, 1, 2};
    if (bound_by_all_solvers(a, b, 3) < 5) return fail("too few solvers bound a distance");
    if (heard != 0) return fail("a signal came");
    for (const int number : signals) {
        std::raise(number);
        if (heard != number) return fail("a signal handler is another one now");
    }
    int subreaper = 0;
    if (::prctl(PR_GET_CHILD_SUBREAPER, &subreaper) != 0 || subreaper) return fail("this process is a subreaper now");
    if (::waitpid(child, nullptr, WNOHANG) != 0) return fail("the child has ended");
    ::kill(child, SIGKILL);
    if (::waitpid(child, nullptr, 0) != child) return fail("somebody else waited for the child");
    return ::waitpid(-1, nullptr, WNOHANG) == -1 && errno == ECHILD ? 0 : fail("there is another child");
}
