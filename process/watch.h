// Kills a process group when this process ends, even by SIGKILL.
#pragma once

#include <sys/types.h>

namespace hausbench {

// From now on this group, alone, is killed when this process ends, for whatever reason; 0: none. The first call starts a shell that waits
// for that: all groups share it, since starting it would count in the times of what runs in them.
void watch_group(pid_t group);

}  // namespace hausbench
