// The list of all solvers that this program can run. CONTRIBUTING.md says how to add one.
#pragma once

#include "algorithms/solver.h"

#include <string_view>
#include <vector>

namespace hausbench {

// Returns the built-in solvers, then the solvers of plug-ins in the order of loading.
const std::vector<SolverEntry>& solvers();

// Adds the solvers of a plug-in. Call it before looking up any solver, because it invalidates references into
// solvers(). Throws InputError if a solver has no name, no `make` function, or a name that is already in use; then
// nothing is added. The message begins with `origin`.
void add_solvers(const std::vector<SolverEntry>& more, const std::string& origin);

// A solver that was left out of this program because its library was missing or switched off.
struct NotBuilt {
    std::string name, reason;
};
const std::vector<NotBuilt>& solvers_not_built();

// Returns a solver by name. Throws InputError if there is none: the message suggests a similar name or, if the solver
// was left out of this program, gives the reason.
const SolverEntry& find_solver(std::string_view name);

}  // namespace hausbench
