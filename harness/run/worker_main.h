// The process that starts workers.
#pragma once

#include "harness/run/work_order.h"

#include <string>
#include <string_view>

namespace hausbench {

// Runs the hidden command `worker`, and returns its exit code. Reads work orders from standard input, as message_of()
// writes them, until the input ends. Each order is carried out by a worker, a copy of this process (fork), so that it
// finds nothing in memory that an earlier one has left there. When the worker has ended, writes `order_done` to the file
// descriptor `events`. If a worker crashes, this process ends in the same way.
int worker_main(int events);

// Returns the bytes that worker_main() reads: the size of the order, then the order.
std::string message_of(const WorkOrder& order);

inline constexpr std::string_view order_done = "{\"event\":\"done\"}";

}  // namespace hausbench
