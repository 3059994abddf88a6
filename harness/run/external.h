// The solver `external`: any program, by its command line. It starts processes, so the program adds it to the registry itself.
#pragma once

#include "algorithms/solver.h"

namespace hausbench {

SolverEntry external_solver();

}  // namespace hausbench
