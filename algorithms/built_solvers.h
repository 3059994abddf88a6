// The solvers that are compiled into a program or library. CMake writes the lists from the lines hausbench_solver(...).
#pragma once

#include "algorithms/solver.h"

#include <vector>

namespace hausbench {

// Returns the solvers of this program or library.
std::vector<SolverEntry> built_solvers();

}  // namespace hausbench
