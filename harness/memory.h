// The memory of this process, as Linux counts it. For other processes see process.h.
#pragma once

#include <cstdint>

namespace hausbench {

// In bytes; -1 where the kernel does not say.
std::int64_t resident_now();
std::int64_t resident_peak();  // since the process began, or since reset_resident_peak()

// Makes the peak start again from the present resident set. False where the kernel does not let us.
bool reset_resident_peak();

}  // namespace hausbench
