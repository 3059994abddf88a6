// What a process has started, down to the last: Linux, /proc.
#pragma once

#include <sys/types.h>

#include <vector>

namespace hausbench {

// A process, first, and all that it has started and that still hang on it. Those whose parent has ended hang on the nearest
// process above that is a subreaper (prctl).
std::vector<pid_t> family_of(pid_t process);

// Kills this process's children and all they have started, but for what is in `spared`, until there are none,
// for up to a second.
void end_family(const std::vector<pid_t>& spared);

}  // namespace hausbench
