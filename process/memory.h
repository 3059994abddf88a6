// Measures the memory of processes, as Linux counts it.
#pragma once

#include <cstdint>

#include <sys/types.h>

namespace hausbench {

// Returns the resident set of a process, in bytes. Returns 0 if the process has ended.
std::int64_t resident_of(pid_t process);

// Returns the proportional set size of a process, in bytes: a page that n processes share counts as 1/n. Returns the
// resident set if the kernel does not provide this size. The kernel visits every page, which takes tens of milliseconds
// for a few gigabytes and may make the process wait.
std::int64_t proportional_bytes_of(pid_t process);

// Returns three quarters of the available memory of the machine, or of the memory limit of the container if that is
// less, in bytes. Using more could make the kernel kill other processes.
std::int64_t spare_bytes();

// Measures the memory that a solver takes: the peak of this process's resident set while the solver prepares and
// solves, minus the resident set before. This is `peak_bytes` in the output of `run` and `measure`. Freed memory that
// the allocator still holds is given back to the system first, because the solver could reuse it without a rise of the
// resident set.
class PeakMemory {
public:
    PeakMemory();        // call when the shapes are loaded but nothing is prepared
    void prepared();     // call when everything is prepared
    void next_answer();  // call before each answer, to exclude memory that earlier answers freed

    // Returns the larger of two peaks: while preparing, and during the answer since the last next_answer(). If another
    // program did the work, returns its peak, `outside_bytes`, unless that is unknown (-1). Returns -1 if the kernel
    // does not allow this measurement.
    std::int64_t peak_bytes(std::int64_t outside_bytes) const;

private:
    bool known_;                            // false if the kernel does not allow the measurement
    std::int64_t before_, preparing_ = -1;  // resident set at construction; peak while preparing
};

}  // namespace hausbench
