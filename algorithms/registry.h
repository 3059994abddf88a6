// The explicit list of solvers. To add one: its .cpp, one line in registry.cpp, one in CMakeLists.txt.
#pragma once

#include "solver.h"

#include <string_view>
#include <vector>

namespace hausbench {

// Solvers compiled into this program, in the order of the list, then those of plug-ins in the order of loading.
const std::vector<SolverEntry>& solvers();

// For plugin.h, before any solver is looked up: references into solvers() do not outlive this. Throws InputError, beginning
// with `origin`, for a name that is taken; nothing is added then.
void add_solvers(const std::vector<SolverEntry>& more, const std::string& origin);

// Solvers the list knows whose library was not found, or was switched off, when this program was built.
struct NotBuilt {
    std::string name, reason;
};
const std::vector<NotBuilt>& solvers_not_built();

// Throws InputError that names the nearest known solver.
const SolverEntry& find_solver(std::string_view name);

}  // namespace hausbench
