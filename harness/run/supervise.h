// Runs one worker: reads its events, kills it at a limit, and makes the outcome of each case.
#pragma once

#include "harness/run/work_order.h"

#include <functional>
#include <string>
#include <vector>

namespace hausbench {

struct Supervision {
    std::function<void(const std::vector<std::string>& left_out)> prepared;
    std::function<void(std::size_t row, Outcome outcome)> finished;  // called once per row
    std::function<bool()> interrupted;
};

// Starts a worker and processes its events until it ends. A case gets its outcome when the worker ends the case. If
// the worker crashes, exceeds its time or memory limit or writes something that is not an event, it is killed, the
// case in flight gets a row with the reason and the worker's last words, and the caller starts another worker for the
// rest. If the shapes of a pair could not be loaded and prepared, all cases of the pair get that row.
//
// If a warm chain breaks at a pose, the poses after it get rows that say so. The poses before it get none, because
// their timings are lost; the caller runs them again from the head of the chain.
//
// If a matrix worker that has answered other pairs runs out of memory, the pair in flight gets no row: the caller
// tries it in a fresh worker, which holds fewer shapes.
//
// At least one item is finished, unless the run is interrupted.
void supervise(const WorkOrder& order, const Supervision& report);

}  // namespace hausbench
