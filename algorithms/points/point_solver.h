// The part of SolverInfo that is the same for all exact solvers of point sets.
#pragma once

#include "algorithms/solver.h"

#include <utility>

namespace hausbench {

// Returns the description of a solver that takes two point sets, computes the exact distance whatever the tolerance,
// and records a trace. The caller sets `certified` and the parameters.
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
