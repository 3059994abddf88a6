#include "harness/run/worker_main.h"

#include "harness/run/worker.h"
#include "process/copy.h"
#include "process/scratch.h"
#include "process/watch.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>

namespace hausbench {

namespace {

// Reads `size` bytes from standard input, without a buffer, so that a copy of this process can read on. Returns whether
// there were so many.
bool read_input(char* bytes, std::size_t size) {
    for (std::size_t done = 0; done < size;) {
        const ssize_t n = ::read(STDIN_FILENO, bytes + done, size - done);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        done += std::size_t(n);
    }
    return true;
}

int carry_out_next(std::uint64_t size, int events) {
    std::string bytes(size, '\0');
    if (!read_input(bytes.data(), size)) return 3;                    // the runner is gone
    ::dup2(::open("/dev/null", O_RDONLY | O_CLOEXEC), STDIN_FILENO);  // what follows is not for this process
    const ScratchFolder folder("worker");
    ::setenv("TMPDIR", folder.path().c_str(), 1);
    return carry_out(unpacked(bytes), events);
}

}  // namespace

std::string message_of(const WorkOrder& order) {
    const std::string bytes = packed(order);
    const std::uint64_t size = bytes.size();
    return std::string(reinterpret_cast<const char*>(&size), sizeof size) + bytes;
}

int worker_main(int events) {
    end_family_with_parent();
    ::fcntl(events, F_SETFD, FD_CLOEXEC);  // not inherited by programs that a solver starts
    const std::string done = std::string(order_done) + '\n';
    for (std::uint64_t size = 0; read_input(reinterpret_cast<char*>(&size), sizeof size);) {
        if (in_a_copy()) return carry_out_next(size, events);
        if (::write(events, done.data(), done.size()) != ssize_t(done.size())) return 3;  // the runner is gone
    }
    return 0;
}

}  // namespace hausbench
