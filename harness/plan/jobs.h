// Arranges the jobs of a plan: which pairs share a worker, and in which order jobs run.
#pragma once

#include "harness/plan/plan.h"

namespace hausbench {

// The jobs of one matrix, solver and set of options become one, or several where scales are more than 2^60 apart. A search stays one
// job, whose shapes are then loaded and scaled pair by pair. Reads each shape of a matrix once, for its extent. O(n) for n jobs.
void join_matrices(Plan& plan);

// Sorts the jobs by scene, and within a scene by seed: each seed runs all its solvers and options before the next seed begins, as
// a round does, so that a slow spell of the machine hits all of them and not one. Every other seed runs in reverse (ABBA). Solvers
// without a seed come first. Stable otherwise.
void interleave_seeds(Plan& plan);

}  // namespace hausbench
