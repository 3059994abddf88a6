#include "memory.h"

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

}  // namespace hausbench
