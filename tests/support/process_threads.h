#pragma once

#include <filesystem>
#include <iterator>

namespace hausbench {

// Returns the number of threads of this process.
inline std::ptrdiff_t threads_of_process() {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return std::distance(begin(tasks), end(tasks));
}

}  // namespace hausbench
