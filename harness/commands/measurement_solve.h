// The part of `measure` that solves.
#pragma once

#include "algorithms/solver.h"
#include "harness/commands/measurement.h"

namespace hausbench {

// Solves, writes the requested fields and the requested certificate, and stores the answer and the reports of these in
// `measured`. Unless the request says otherwise, this happens in a child process.
void solve(const MeasureRequest& request, const SolverEntry& entry, const Tolerance& tolerance, Shape source,
           Shape target, Measured& measured);

}  // namespace hausbench
