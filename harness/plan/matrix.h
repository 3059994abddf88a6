// Joins the pairs of a matrix into jobs, so that each of its shapes is loaded and prepared once.
#pragma once

#include "harness/plan/plan.h"

namespace hausbench {

// The jobs of one matrix, solver and set of options become one, or several where scales are more than 2^60 apart. A search stays one
// job, whose shapes are then loaded and scaled pair by pair. Reads each shape of a matrix once, for its extent. O(n) for n jobs.
void join_matrices(Plan& plan);

}  // namespace hausbench
