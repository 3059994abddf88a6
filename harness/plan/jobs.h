// Arranges the jobs of a plan: which pairs share a worker, and in which order jobs run.
#pragma once

#include "harness/plan/plan.h"

namespace hausbench {

// Joins the jobs of one solver and set of options on all pairs of a matrix (ScenePlan::matrix) into one job, so that
// its worker loads and prepares each shape only once. A worker scales all its shapes by the same power of two. Pairs
// that need scales more than 2^60 apart therefore go to different jobs. A search is always one job; if its pairs
// cannot have one scale, the worker loads and scales the shapes for each pair anew. Reads each shape of a matrix once,
// for its largest and smallest coordinates. O(n) for n jobs.
void join_matrices(Plan& plan);

// Sorts the jobs by scene, and within a scene by the solver's parameter `seed`. All solvers and options run with one
// seed before the next seed begins, so that a slow spell of the machine hits all solvers and not just one. Every other
// seed runs its jobs in reverse order (ABBA). Solvers without a seed come first. Jobs of the same scene and seed
// otherwise keep their order.
void interleave_seeds(Plan& plan);

}  // namespace hausbench
