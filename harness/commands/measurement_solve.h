// The solving part of `measure`, which runs in a process of its own.
#pragma once

#include "commands/measurement.h"
#include "solver.h"

#include <functional>

namespace hausbench {

struct MeasureWork {
    const SolverEntry& entry;
    const MeasureRequest& request;
    Tolerance tolerance;
};

// Prepares, says so, solves, and fills in the answers of `measured`.
void prepare_and_solve(const MeasureWork& work, Shape source, Shape target, Measured& measured,
                       const std::function<void()>& prepared, const std::function<void()>& answered);

// The same in a process of its own.
void solve_outside(const MeasureWork& work, Shape source, Shape target, Measured& measured);

}  // namespace hausbench
