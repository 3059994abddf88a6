// Kills a process group when this process ends, even by SIGKILL.
#pragma once

#include <sys/types.h>

namespace hausbench {

// Kills this process group when this process ends for whatever reason; replaces the group of an earlier call; 0:
// none. The first call starts a shell that waits for the end. All groups share it, because starting one per group
// would distort the times of the work in the group.
void watch_group(pid_t group);

// If the process that started this one ends, kills all descendants of this process and then this process itself. The
// descendants include those that left its group or session (setsid), which no process could find afterwards. Call it
// before another thread starts.
void end_family_with_parent();

}  // namespace hausbench
