// Runs one worker process: reads its events (worker.cpp), kills it at a limit, and makes an outcome for each case.
#pragma once

#include "harness/run/work_order.h"

#include <functional>
#include <string>
#include <vector>

namespace hausbench {

// Callbacks of supervise().
struct Supervision {
    // Called when a pair is prepared. `left_out`: names of the structures that the solver did not need.
    std::function<void(const std::vector<std::string>& left_out)> prepared;
    std::function<void(std::size_t row, Outcome outcome)> finished;  // called once for each row that gets an outcome
    std::function<bool()> interrupted;                               // polled; true ends the worker
};

// Starts a worker and processes its events until it ends. A case gets its outcome when the worker sends "end" for it.
// The caller starts another worker for cases that have no outcome when supervise() returns.
//
// The worker is killed if it exceeds its time or memory limit, or if it writes something that is not an event. If it is
// killed or crashes, the case that it was answering gets an outcome with the reason and the end of the worker's output:
// - If the worker was still loading and preparing a pair, all cases of the pair get this outcome.
// - If the worker had answered the case and was timing repeats, the answer counts.
// - If the case is a pose of a warm chain, later poses are `failed`, because they depend on it. Earlier poses get no
//   outcome, because their timings are lost: the next worker runs the chain again from its first pose.
// - If the worker of a matrix ran out of memory after it had answered other pairs, the present pair gets no outcome.
//   The next worker may have room for it, because it holds fewer shapes.
//
// Each call gives at least one case an outcome, unless the run is interrupted.
void supervise(const WorkOrder& order, const Supervision& report);

}  // namespace hausbench
