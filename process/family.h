// Lists and kills the descendants of a process (Linux, /proc).
#pragma once

#include <sys/types.h>

#include <vector>

namespace hausbench {

// Returns a process, first, and all its descendants. A process whose parent has ended becomes a child of the nearest
// ancestor that is a subreaper (prctl). Processes in `spared` are left out, with their descendants.
std::vector<pid_t> family_of(pid_t process, const std::vector<pid_t>& spared = {});

// Kills all descendants of this process except `spared` and their descendants. Repeats until none is left, for at
// most a second.
void end_family(const std::vector<pid_t>& spared);

}  // namespace hausbench
