#include "process/memory.h"

#include <fmt/format.h>

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>

namespace hausbench {

namespace {

// Returns the size, in bytes, on the line of a /proc file that starts with `key`. Returns -1 if no line does.
std::int64_t size_in(const std::string& file, std::string_view key) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with(key)) return 1024 * std::stoll(line.substr(key.size()));  // given in kB
    }
    return -1;
}

std::int64_t resident_now() { return size_in("/proc/self/status", "VmRSS:"); }

std::int64_t resident_peak() { return size_in("/proc/self/status", "VmHWM:"); }

// Resets the peak to the present resident set. Returns false if the kernel does not allow it.
bool reset_resident_peak() { return bool(std::ofstream("/proc/self/clear_refs") << "5" << std::flush); }

}  // namespace

std::int64_t resident_of(pid_t process) {
    std::ifstream in(fmt::format("/proc/{}/statm", process));
    std::int64_t size = 0, resident = 0;
    in >> size >> resident;
    return resident * ::sysconf(_SC_PAGE_SIZE);
}

std::int64_t proportional_bytes_of(pid_t process) {
    const std::int64_t bytes = size_in(fmt::format("/proc/{}/smaps_rollup", process), "Pss:");
    return bytes < 0 ? resident_of(process) : bytes;
}

std::int64_t spare_bytes() {
    std::int64_t spare = std::numeric_limits<std::int64_t>::max(), number = 0;
    std::string key, unit;
    for (std::ifstream in("/proc/meminfo"); in >> key >> number && std::getline(in, unit);)
        if (key == "MemAvailable:") spare = number * 1024;
    for (const char* file : {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"})
        if (std::ifstream in(file); in >> number) spare = std::min(spare, number);  // skips "max", no limit
    return spare / 4 * 3;
}

PeakMemory::PeakMemory() {
    ::malloc_trim(0);
    before_ = resident_now();
    known_ = reset_resident_peak() && before_ >= 0;
}

void PeakMemory::prepared() { preparing_ = resident_peak(); }

void PeakMemory::next_answer() {
    ::malloc_trim(0);
    known_ = reset_resident_peak() && known_;
}

std::int64_t PeakMemory::peak_bytes(std::int64_t outside_bytes) const {
    if (outside_bytes >= 0) return outside_bytes;
    return known_ ? std::max<std::int64_t>(0, std::max(preparing_, resident_peak()) - before_) : -1;
}

}  // namespace hausbench
