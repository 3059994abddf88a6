// Options for tests that try every solver on many scenes.
#pragma once

#include "algorithms/solver.h"

#include <variant>
#include <vector>

namespace hausbench {

// Returns the defaults, except for a larger step of `sampling`, whose default (MESH's) takes many samples.
inline Options quick_options(const SolverEntry& entry, ParameterMap given = {}) {
    if (entry.info.name == "sampling") given.try_emplace("step", 0.05);
    return {entry.info.name, entry.info.parameters, given};
}

// Returns the defaults, and one variant for each flag and each choice that differs from them.
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

// Returns whether the solver reaches the tolerance on any scene well within the range of doubles. `sampling` does not:
// its interval is as wide as its step.
inline bool reaches_the_tolerance(const SolverInfo& info) { return info.certified && info.name != "sampling"; }

}  // namespace hausbench
