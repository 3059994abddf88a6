// The worker process: loads shapes, prepares a solver, answers and times cases, and tells the runner through a pipe.
#pragma once

namespace hausbench {

// Runs the hidden command `worker`, and returns its exit code. Writes one JSON object per line to the file descriptor
// `events` (see worker.cpp).
int worker_main(int events);

}  // namespace hausbench
