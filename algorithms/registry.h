// The explicit list of solvers. To add one: its .cpp, one line in registry.cpp, one in CMakeLists.txt.
#pragma once

#include "solver.h"

#include <string_view>
#include <vector>

namespace hausbench {

// Solvers compiled into this program, in the order of the list.
const std::vector<SolverEntry>& solvers();

// Solvers the list knows whose library was not found, or was switched off, when this program was built.
struct NotBuilt {
    std::string name, reason;
};
const std::vector<NotBuilt>& solvers_not_built();

// Throws InputError that names the nearest known solver.
const SolverEntry& find_solver(std::string_view name);

}  // namespace hausbench
