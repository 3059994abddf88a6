// Kills a process group when this process ends, even by SIGKILL.
#pragma once

#include <sys/types.h>

namespace hausbench {

// Arranges that a process group is killed when this process ends, for whatever reason. Only the group of the last call
// is killed; 0: none. The first call starts a shell that waits for the end of this process. Later calls reuse the
// shell, because starting another would distort times measured in the group.
void watch_group(pid_t group);

// Arranges that this process and all its descendants are killed when its parent ends. This includes descendants that
// left its group or session (setsid), which could not be found later. Call it before starting other threads, because
// they must inherit the signals that it blocks.
void end_family_with_parent();

}  // namespace hausbench
