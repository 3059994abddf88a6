// Measures the memory of processes, as Linux counts it.
#pragma once

#include <cstdint>

#include <sys/types.h>

namespace hausbench {

// The resident set of a process, in bytes; 0 if it has ended.
std::int64_t resident_of(pid_t process);

// Its proportional set in bytes, in which a page that n processes share counts 1/n; its resident set if the kernel does not say. Walks all
// of its pages: tens of milliseconds for some gigabytes, during which the process may have to wait.
std::int64_t proportional_bytes_of(pid_t process);

// Three quarters of the free memory of the machine or the container: more could make the kernel kill other processes.
std::int64_t spare_bytes();

// What a solver takes: the peak of this process's resident set while it prepares and solves, less the resident set before. The one
// meaning of `peak_bytes`, for `run` and `measure`. What the allocator keeps of memory that was freed is handed back first,
// because it would hide what is allocated next.
class PeakMemory {
public:
    PeakMemory();        // the shapes are loaded, nothing is prepared
    void prepared();     // all is prepared
    void next_answer();  // before each answer: what earlier ones took and freed does not count

    // Of preparing and of this answer, whichever took more; `outside_bytes` instead where a program outside did the work
    // and its peak is known (not -1). -1 where nothing is known.
    std::int64_t peak_bytes(std::int64_t outside_bytes) const;

private:
    bool known_;
    std::int64_t before_, preparing_ = -1;
};

}  // namespace hausbench
