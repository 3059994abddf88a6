// The worker process: loads shapes, prepares a solver, answers and times cases, and tells the runner through a pipe.
#pragma once

namespace hausbench {

// Runs the hidden verb `worker`, which writes one JSON object per line to file descriptor `events` (see worker.cpp).
// Returns the exit code.
int worker_main(int events);

}  // namespace hausbench
