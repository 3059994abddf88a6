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

// What is called when a step is done.
struct MeasureSteps {
    std::function<void()> prepared = [] {}, answered = [] {};
    std::function<void()> drawn = [] {};   // the last of Measured::drawn is written
    std::function<void()> proved = [] {};  // the certificate is written, and not checked yet
};

// Prepares, solves, and fills in the answers of `measured`.
void prepare_and_solve(const MeasureWork& work, Shape source, Shape target, Measured& measured,
                       const MeasureSteps& steps);

// The same in a process of its own.
void solve_outside(const MeasureWork& work, Shape source, Shape target, Measured& measured);

}  // namespace hausbench
