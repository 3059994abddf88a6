// Options for tests that try every solver on many scenes.
#pragma once

#include "solver.h"

namespace hausbench {

// The defaults, but for `sampling`, which gets fewer samples than MESH takes by default.
inline Options quick_options(const SolverEntry& entry, ParameterMap given = {}) {
    if (entry.info.name == "sampling") given.try_emplace("step", 0.05);
    return {entry.info.name, entry.info.parameters, given};
}

// Whether it comes as close as the tolerance asks, on any scene that doubles hold easily. What samples prove is as wide as their step.
inline bool reaches_the_tolerance(const SolverInfo& info) { return info.certified && info.name != "sampling"; }

}  // namespace hausbench
