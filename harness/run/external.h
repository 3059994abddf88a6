// The solver `external`, which runs another program, given its command line. It is not in the library of solvers,
// because it starts processes; main() adds it to the registry.
#pragma once

#include "algorithms/solver.h"

namespace hausbench {

SolverEntry external_solver();

}  // namespace hausbench
