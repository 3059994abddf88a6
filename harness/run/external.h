// The solver `external`, which runs any program by its command line. Since it starts processes, the program adds it
// to the registry itself.
#pragma once

#include "algorithms/solver.h"

namespace hausbench {

SolverEntry external_solver();

}  // namespace hausbench
