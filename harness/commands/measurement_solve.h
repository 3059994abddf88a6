// The part of `measure` that solves. It runs in a process of its own.
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

// Callbacks of prepare_and_solve(), called after each step.
struct MeasureSteps {
    std::function<void()> prepared = [] {}, answered = [] {};
    std::function<void()> closer = [] {};  // `measured` holds bounds, and more work may bring them closer
    std::function<void()> drawn = [] {};   // a file of fields is written; Measured::drawn.back() describes it
    std::function<void()> proved = [] {};  // the certificate is written but not checked yet
};

// Prepares and solves, writes the requested files, and stores the answers in `measured`.
void prepare_and_solve(const MeasureWork& work, Shape source, Shape target, Measured& measured,
                       const MeasureSteps& steps);

// Like prepare_and_solve(), but in a child process, so that a crash of the solver ends only that process.
void solve_outside(const MeasureWork& work, Shape source, Shape target, Measured& measured);

}  // namespace hausbench
