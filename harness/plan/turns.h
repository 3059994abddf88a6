// The order in which the jobs of a scene are run.
#pragma once

#include "harness/plan/plan.h"

namespace hausbench {

// Sorts the jobs by scene, and within a scene by seed: each seed runs all its solvers and options before the next seed begins, as
// a round does, so that a slow spell of the machine hits all of them and not one. Every other seed runs in reverse (ABBA). Solvers
// without a seed come first. Stable otherwise.
void interleave_seeds(Plan& plan);

}  // namespace hausbench
