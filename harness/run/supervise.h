// Runs one worker: reads its events, kills it at a limit, and makes the outcome of each case.
#pragma once

#include "harness/run/work_order.h"

#include <functional>
#include <string>
#include <vector>

namespace hausbench {

struct Supervision {
    std::function<void(const std::vector<std::string>& left_out)> prepared;
    std::function<void(std::size_t row, Outcome outcome)> finished;  // each once
    std::function<bool()> interrupted;
};

// Starts a worker and hears it out. A case gets its outcome when the worker ends it; if the worker crashes, hangs past its
// limits, grows past its memory or writes what is no event, it is killed, the case in flight gets its row with the reason and
// the worker's last words, and the caller starts another for the rest. If a pair never got ready, all its cases get that row.
// Where a warm chain breaks at a pose, the poses after it get rows that say so, and those before it none: their timings are lost,
// so the caller has them run again from the head.
// Where a matrix worker that has answered other pairs runs out of memory, the pair in flight gets no row: the caller tries it in a
// fresh worker, which holds fewer shapes.
// At least one item is finished, unless interrupted.
void supervise(const WorkOrder& order, const Supervision& report);

}  // namespace hausbench
