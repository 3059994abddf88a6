// The SolverInfo common to all solvers for point sets.
#pragma once

#include "algorithms/solver.h"

#include <utility>

namespace hausbench {

// Returns the info of an exact solver, which ignores the tolerance. The caller sets `certified`.
inline SolverInfo point_solver_info(std::string name, std::string title, std::string paper) {
    SolverInfo info;
    info.name = std::move(name);
    info.title = std::move(title);
    info.paper = std::move(paper);
    info.source.points = info.target.points = true;
    info.ignores_tolerance = true;
    info.abilities.insert({Ability::traces, Ability::coarser_answers});
    return info;
}

}  // namespace hausbench
