// The list of all solvers that this program can run. CONTRIBUTING.md says how to add one.
#pragma once

#include "algorithms/solver.h"

#include <string_view>
#include <vector>

namespace hausbench {

// Returns the built-in solvers, then the solvers of plug-ins in the order of loading.
const std::vector<SolverEntry>& solvers();

// Adds the solvers of a plug-in. Call this before looking up any solver, because it invalidates references into
// solvers(). Adds nothing and throws InputError if a solver has no name or no `make` function, or if its name is
// already in use. The error message begins with `origin`.
void add_solvers(const std::vector<SolverEntry>& more, const std::string& origin);

// A solver that was left out of this program because its library was missing or switched off.
struct NotBuilt {
    std::string name, reason;
};
const std::vector<NotBuilt>& solvers_not_built();

// Returns a solver by name. Throws InputError for an unknown name. The message then suggests a similar one, or says
// why the solver was left out of this program.
const SolverEntry& find_solver(std::string_view name);

}  // namespace hausbench
