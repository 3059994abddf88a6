// Kills a process group when this process ends, even by SIGKILL.
#pragma once

#include <sys/types.h>

namespace hausbench {

// From now on this group, alone, is killed when this process ends, for whatever reason; 0: none. The first call starts a shell that waits
// for that: all groups share it, since starting it would count in the times of what runs in them.
void watch_group(pid_t group);

// From now on, if the process that started this one ends, all descendants of this process are killed before it ends itself: also those
// that left its group or session (setsid), which nobody could find afterwards. Call it before another thread starts.
void end_family_with_parent();

}  // namespace hausbench
