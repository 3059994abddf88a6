#include "process/family.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>

namespace hausbench {

std::vector<pid_t> family_of(pid_t process, const std::vector<pid_t>& spared) {
    std::vector<pid_t> all{process};
    for (std::size_t i = 0; i < all.size(); ++i) {
        const pid_t parent = all[i];
        // The kernel lists each child under the thread that started it, so the lists of all threads are read.
        std::error_code gone;
        for (std::filesystem::directory_iterator thread(fmt::format("/proc/{}/task", parent), gone), end;
             !gone && thread != end; thread.increment(gone)) {
            std::ifstream children(thread->path() / "children");
            for (pid_t child = 0; children >> child;) {
                if (std::find(spared.begin(), spared.end(), child) == spared.end()) all.push_back(child);
            }
        }
    }
    return all;
}

void end_family(const std::vector<pid_t>& spared) {
    // Gives up after a second: a process that is blocked in the kernel dies only when its system call returns.
    for (int tries = 0; tries < 1000; ++tries) {
        bool any = false;
        for (const pid_t member : family_of(::getpid(), spared)) {
            if (member == ::getpid()) continue;
            any = true;
            ::kill(member, SIGKILL);
            ::waitpid(member, nullptr, WNOHANG);  // reaps it if it is a child of this process and has ended
        }
        if (!any) return;
        ::usleep(1000);
    }
}

}  // namespace hausbench
