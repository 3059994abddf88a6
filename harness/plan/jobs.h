// Arranges the jobs of a plan: which pairs share a worker, and in which order jobs run.
#pragma once

#include "harness/plan/plan.h"

namespace hausbench {

// Joins the jobs of one matrix, solver and set of options into one, or into several if scales are more than 2^60
// apart. A search always stays one job; if its scales differ too much, its shapes are loaded and scaled pair by pair.
// Reads each shape of a matrix once, for its extent. O(n) for n jobs.
void join_matrices(Plan& plan);

// Sorts the jobs by scene, and within a scene by seed: each seed runs with all its solvers and options before the
// next seed begins, as in a round, so that a slow spell of the machine hits all solvers and not just one. Every other
// seed runs in reverse (ABBA). Solvers without a seed come first. Otherwise stable.
void interleave_seeds(Plan& plan);

}  // namespace hausbench
