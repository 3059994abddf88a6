// A worker: loads shapes, prepares a solver, answers and times cases, and tells the runner through a pipe.
#pragma once

#include "harness/run/work_order.h"

namespace hausbench {

// Carries out a work order, and returns the exit code of the process. Writes one JSON object per line to the file
// descriptor `events` (see worker.cpp).
int carry_out(WorkOrder order, int events);

}  // namespace hausbench
