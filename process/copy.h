// Runs pieces of work one after the other, each in a copy of a process that has only been started.
#pragma once

namespace hausbench {

// Makes a copy of this process (fork) and returns true in it. In the original, waits for the end of the copy, kills the
// descendants that it left behind, and returns false if it ended with exit code 0. If the copy ended in another way, the
// original ends in the same way: by the same signal, or with the same exit code.
//
// The copy is killed when the original ends. It has only the calling thread, so no other thread may hold a lock that the
// copy needs. The original must be a subreaper (prctl) to find descendants whose parents have ended. Throws
// std::runtime_error if no process can be started.
bool in_a_copy();

}  // namespace hausbench
