// The solving part of `measure`, which runs in a process of its own.
#pragma once

#include "algorithms/solver.h"
#include "harness/commands/measurement.h"

#include <functional>

namespace hausbench {

struct MeasureWork {
    const SolverEntry& entry;
    const MeasureRequest& request;
    Tolerance tolerance;
};

// Functions that prepare_and_solve() calls after each step.
struct MeasureSteps {
    std::function<void()> prepared = [] {}, answered = [] {};
    std::function<void()> drawn = [] {};   // the file described by the last entry of Measured::drawn is written
    std::function<void()> proved = [] {};  // the certificate is written but not checked yet
};

// Prepares, solves, and fills in the answers of `measured`.
void prepare_and_solve(const MeasureWork& work, Shape source, Shape target, Measured& measured,
                       const MeasureSteps& steps);

// Does the same in a process of its own.
void solve_outside(const MeasureWork& work, Shape source, Shape target, Measured& measured);

}  // namespace hausbench
