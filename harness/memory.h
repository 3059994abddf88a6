// The memory of this process, as Linux counts it. For other processes see process.h.
#pragma once

#include <cstdint>

namespace hausbench {

// In bytes; -1 where the kernel does not say.
std::int64_t resident_now();
std::int64_t resident_peak();  // since the process began, or since reset_resident_peak()

// Makes the peak start again from the present resident set. False where the kernel does not let us.
bool reset_resident_peak();

// What a solver takes: the peak of the resident set while it prepares and solves, less the resident set before. The one
// meaning of `peak_bytes`, for `run` and `measure`. What the allocator keeps of memory that was freed is handed back first,
// because it would hide what is allocated next.
class SolverMemory {
public:
    SolverMemory();      // the shapes are loaded, nothing is prepared
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
