// What a solver for point sets says of itself.
#pragma once

#include "algorithms/solver.h"

#include <utility>

namespace hausbench {

// Exact, so that no tolerance matters. `certified` is for the solver to say.
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
