// Arranges the jobs of a plan: which pairs of shapes share a worker process, and in which order the jobs run.
#pragma once

#include "harness/plan/plan.h"

namespace hausbench {

// Joins the jobs of a matrix (ScenePlan::matrix) that have the same solver and options into one job, so that its worker
// loads and prepares each shape only once. Reads each shape, to find its largest and smallest coordinates. O(n) for n
// jobs.
//
// A worker scales all its shapes by one power of two. Pairs that need scales more than a factor of 2^60 apart therefore
// go to different jobs. A search is always one job; if no scale suits all its pairs, the worker loads and scales the
// shapes anew for each pair.
void join_matrices(Plan& plan);

// Sorts the jobs by scene, then by the solver's parameter `seed`; solvers without a seed come first. All solvers run
// with one seed before the next seed begins, so that a slow spell of the machine affects all of them. Every other seed
// runs its jobs in reverse order (ABBA).
void interleave_seeds(Plan& plan);

}  // namespace hausbench
