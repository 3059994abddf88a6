// The list of solvers. To add one: its .cpp, and one line in the CMakeLists.txt of its folder; CONTRIBUTING.md has the rest.
#pragma once

#include "algorithms/solver.h"

#include <string_view>
#include <vector>

namespace hausbench {

// Solvers compiled into this program, in the order of the list, then those of plug-ins in the order of loading.
const std::vector<SolverEntry>& solvers();

// For plugin.h; call it before any solver is looked up: it invalidates references into solvers(). Throws InputError, which
// begins with `origin`, for a name that is already in use; then nothing is added.
void add_solvers(const std::vector<SolverEntry>& more, const std::string& origin);

// Solvers that are not in this program: their library was not found, or was switched off, when it was built.
struct NotBuilt {
    std::string name, reason;
};
const std::vector<NotBuilt>& solvers_not_built();

// Throws InputError that names the nearest known solver.
const SolverEntry& find_solver(std::string_view name);

}  // namespace hausbench
