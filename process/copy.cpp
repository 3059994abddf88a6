#include "process/copy.h"

#include "process/family.h"

#include <fmt/format.h>

#include <link.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace hausbench {

namespace {

// Maps all code and constants of the program, without its libraries. A fork leaves them out of the page tables of the
// copy, which would otherwise map them while a solver is timed and its memory measured. Does nothing before Linux 5.14.
void map_program() {
    ::dl_iterate_phdr(
        [](dl_phdr_info* loaded, std::size_t, void*) {
            const std::uintptr_t page = std::uintptr_t(::sysconf(_SC_PAGE_SIZE));
            for (int i = 0; i < loaded->dlpi_phnum; ++i) {
                const auto& part = loaded->dlpi_phdr[i];
                if (part.p_type != PT_LOAD || (part.p_flags & PF_W)) continue;
                const std::uintptr_t begin = (loaded->dlpi_addr + part.p_vaddr) & ~(page - 1);
                const std::uintptr_t end = loaded->dlpi_addr + part.p_vaddr + part.p_memsz;
                static_cast<void>(::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_POPULATE_READ));
            }
            return 1;  // the program comes first; mapping all its libraries would take longer than many cases
        },
        nullptr);
}

// Ends this process by a signal that has ended its copy. It writes no second dump of memory.
[[noreturn]] void end_by(int signal) {
    const rlimit none{0, 0};
    ::setrlimit(RLIMIT_CORE, &none);
    ::signal(signal, SIG_DFL);
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, signal);
    ::pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
    ::raise(signal);
    ::_exit(128 + signal);
}

}  // namespace

bool in_a_copy() {
    std::fflush(nullptr);  // otherwise the copy would write buffered output a second time
    const pid_t original = ::getpid();
    const pid_t copy = ::fork();
    if (copy < 0) throw std::runtime_error(fmt::format("cannot start a process: {}", std::strerror(errno)));
    if (copy == 0) {
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (::getppid() != original) ::_exit(127);
        map_program();
        return true;
    }
    int status = 0;
    while (::waitpid(copy, &status, 0) < 0 && errno == EINTR) {
    }
    pid_t orphan;
    do orphan = ::waitpid(-1, nullptr, WNOHANG);  // reaps orphans that have ended
    while (orphan > 0);
    if (orphan == 0) end_family({});  // others still run
    if (WIFSIGNALED(status)) end_by(WTERMSIG(status));
    if (WEXITSTATUS(status) != 0) ::_exit(WEXITSTATUS(status));
    return false;
}

}  // namespace hausbench
