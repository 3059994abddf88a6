#include "memory.h"

#include <malloc.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <string_view>

namespace hausbench {

namespace {

std::int64_t from_status(std::string_view key) {
    std::ifstream in("/proc/self/status");
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with(key)) return 1024 * std::stoll(line.substr(key.size()));  // given in kB
    }
    return -1;
}

}  // namespace

std::int64_t resident_now() { return from_status("VmRSS:"); }

std::int64_t resident_peak() { return from_status("VmHWM:"); }

bool reset_resident_peak() { return bool(std::ofstream("/proc/self/clear_refs") << "5" << std::flush); }

SolverMemory::SolverMemory() {
    ::malloc_trim(0);
    before_ = resident_now();
    known_ = reset_resident_peak() && before_ >= 0;
}

void SolverMemory::prepared() { preparing_ = resident_peak(); }

void SolverMemory::next_answer() {
    ::malloc_trim(0);
    known_ = reset_resident_peak() && known_;
}

std::int64_t SolverMemory::peak_bytes(std::int64_t outside_bytes) const {
    if (outside_bytes >= 0) return outside_bytes;
    return known_ ? std::max<std::int64_t>(0, std::max(preparing_, resident_peak()) - before_) : -1;
}

}  // namespace hausbench
