// Measures the memory of processes, as Linux counts it.
#pragma once

#include <cstdint>

#include <sys/types.h>

namespace hausbench {

// Returns the resident set of a process, in bytes; 0 if it has ended.
std::int64_t resident_of(pid_t process);

// Returns the proportional set of a process in bytes, in which a page that n processes share counts 1/n; its resident
// set if the kernel does not say. Walks all of its pages: this takes tens of milliseconds for some gigabytes, during
// which the process may have to wait.
std::int64_t proportional_bytes_of(pid_t process);

// Returns three quarters of the free memory of the machine or the container, in bytes: using more could make the
// kernel kill other processes.
std::int64_t spare_bytes();

// Measures the memory that a solver takes: the peak of this process's resident set while it prepares and solves,
// minus the resident set before. This defines `peak_bytes` for both `run` and `measure`. Freed memory that the
// allocator keeps is returned to the system first, because reusing it would hide later allocations.
class PeakMemory {
public:
    PeakMemory();        // call when the shapes are loaded but nothing is prepared
    void prepared();     // call when everything is prepared
    void next_answer();  // call before each answer, to exclude memory that earlier answers freed

    // Returns the peak of preparing and of this answer, whichever is larger. Returns `outside_bytes` instead if an
    // outside program did the work and its peak is known (not -1). -1 if nothing is known.
    std::int64_t peak_bytes(std::int64_t outside_bytes) const;

private:
    bool known_;
    std::int64_t before_, preparing_ = -1;
};

}  // namespace hausbench
