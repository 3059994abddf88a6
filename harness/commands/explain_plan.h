// `hausbench explain S.toml`: what a run would prepare, run and leave out, why, and about how long it would take.
#pragma once

#include "harness/plan/plan.h"

#include <filesystem>
#include <string>

namespace hausbench {

// Times and memory are those of Estimates, from the result files in `results`.
std::string explain(const Plan& plan, const std::filesystem::path& results);

}  // namespace hausbench
