// Compiled twice, with two pairs of lists: for the program, and for the C library, which has no solver under
// the GPL and none of algebraic surfaces.
#include "algorithms/built_solvers.h"

#include "algorithms/registry.h"

namespace hausbench {

// Declares the function NAME::solver() of each solver, which the solver's own file defines. CMake writes solvers.inc: it
// has a line SOLVER(NAME) for each hausbench_solver(NAME ...) in a CMakeLists.txt.
#define SOLVER(name)      \
    namespace name {      \
    SolverEntry solver(); \
    }
#include "solvers.inc"
#undef SOLVER

std::vector<SolverEntry> built_solvers() {
    return {
#define SOLVER(name) name::solver(),
#include "solvers.inc"
#undef SOLVER
    };
}

const std::vector<NotBuilt>& solvers_not_built() {
    static const std::vector<NotBuilt> list = {
#define NOT_BUILT(name, reason) {#name, reason},
#include "not_built.inc"
#undef NOT_BUILT
    };
    return list;
}

}  // namespace hausbench
