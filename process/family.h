// Lists and kills the descendants of a process (Linux, /proc).
#pragma once

#include <sys/types.h>

#include <vector>

namespace hausbench {

// Returns a process and all its descendants, except processes in `spared` and their descendants. A descendant whose
// parent has ended is found only if an ancestor is a subreaper (prctl): the nearest one becomes its new parent.
std::vector<pid_t> family_of(pid_t process, const std::vector<pid_t>& spared = {});

// Kills all descendants of this process except those in `spared` and their descendants. Repeats until none is left,
// for at most a second.
void end_family(const std::vector<pid_t>& spared);

}  // namespace hausbench
