// Supervises a worker: reads its events (worker.cpp), kills it at a limit, and makes an outcome for each case.
#pragma once

#include "harness/run/work_order.h"
#include "process/child.h"

#include <functional>
#include <optional>
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

// Gives the order to a worker and processes its events until it ends. A case gets its outcome when the worker sends
// "end" for it. The caller gives cases that have no outcome when supervise() returns to another worker.
//
// `worker` is the process that starts workers, as copies of itself: loading the program and its libraries takes longer
// than many cases. If it is empty, it is started on the cores of the order. After a worker that was killed or crashed,
// it is empty again. The order must be for the same cores as earlier orders to the same process.
//
// The worker is killed if it exceeds its time or memory limit, or if it writes something that is not an event. If it is
// killed or crashes, the case that it was answering gets an outcome with the reason, the end of the worker's output and
// the last bounds that the worker had sent for it:
// - If the worker was still loading and preparing a pair, all cases of the pair get this outcome.
// - If the worker had answered the case and was timing repeats, the answer counts.
// - If the case is a pose of a warm chain, later poses are `failed`, because they depend on it. Earlier poses get no
//   outcome, because their timings are lost: the next worker runs the chain again from its first pose.
// - If the worker of a matrix ran out of memory after it had answered other pairs, the present pair gets no outcome.
//   The next worker may have room for it, because it holds fewer shapes.
//
// Each call gives at least one case an outcome, unless the run is interrupted.
void supervise(const WorkOrder& order, const Supervision& report, std::optional<Child>& worker);

}  // namespace hausbench
