// `hausbench explain S.toml`: what a run would prepare, run and leave out, why, and about how long it would take.
#pragma once

#include "plan/plan.h"

#include <filesystem>
#include <string>

namespace hausbench {

// Times come from result files in `results` (this machine's): of the same case; else of the same solver on other shapes,
// scaled by the work to be expected; else from that work alone and a rough cost of one distance. The work to be expected
// is |A| |B| distances for naive and k (|A| + |B|) for the others.
std::string explain(const Plan& plan, const std::filesystem::path& results);

}  // namespace hausbench
