// The list of solvers. CONTRIBUTING.md says how to add one.
#pragma once

#include "algorithms/solver.h"

#include <string_view>
#include <vector>

namespace hausbench {

// Returns the built-in solvers, then the solvers of plug-ins in the order of loading.
const std::vector<SolverEntry>& solvers();

// Adds the solvers of a plug-in. Call it before looking up any solver, because it invalidates references into solvers().
// Throws InputError, which begins with `origin`, if a name is already in use; then nothing is added.
void add_solvers(const std::vector<SolverEntry>& more, const std::string& origin);

// A solver that was left out of this program because its library was missing or switched off.
struct NotBuilt {
    std::string name, reason;
};
const std::vector<NotBuilt>& solvers_not_built();

// Returns a solver by name. Throws InputError that suggests the nearest known name.
const SolverEntry& find_solver(std::string_view name);

}  // namespace hausbench
