// Options for tests that try every solver on many scenes.
#pragma once

#include "algorithms/solver.h"

#include <variant>
#include <vector>

namespace hausbench {

// The defaults, but for `sampling`, which gets fewer samples than MESH takes by default.
inline Options quick_options(const SolverEntry& entry, ParameterMap given = {}) {
    if (entry.info.name == "sampling") given.try_emplace("step", 0.05);
    return {entry.info.name, entry.info.parameters, given};
}

// The defaults, and each flag and each choice otherwise.
inline std::vector<ParameterMap> variants_of(const SolverEntry& entry) {
    std::vector<ParameterMap> variants{{}};
    for (const ParameterSpec& spec : entry.info.parameters) {
        if (const bool* flag = std::get_if<bool>(&spec.default_value)) variants.push_back({{spec.name, !*flag}});
        for (const std::string& choice : spec.choices) {
            if (std::get<std::string>(spec.default_value) != choice) variants.push_back({{spec.name, choice}});
        }
    }
    return variants;
}

// Whether it comes as close as the tolerance asks, on any scene that doubles hold easily. What samples prove is as wide as their step.
inline bool reaches_the_tolerance(const SolverInfo& info) { return info.certified && info.name != "sampling"; }

}  // namespace hausbench
