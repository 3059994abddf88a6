// Kills a process group when this process ends, even by SIGKILL.
#pragma once

#include <sys/types.h>

namespace hausbench {

// Arranges that a process group is killed when this process ends, for whatever reason. Only the group of the last call
// is killed; 0: none. The first call starts a shell that waits for the end of this process. Later calls use the same
// shell, because starting another one would distort the times that are measured in the group.
void watch_group(pid_t group);

// Arranges that, when the process that started this one ends, all descendants of this process are killed and then this
// process itself. This includes descendants that left its group or session (setsid), which could not be found after
// its end. Call it before starting other threads, because they must inherit the signals that it blocks.
void end_family_with_parent();

}  // namespace hausbench
