// `hausbench list`: solvers with their parameters, experiments with their scenes, models.
#pragma once

#include <nlohmann/json.hpp>

#include <string>

namespace hausbench {

nlohmann::json list_as_json();
std::string list_as_text();

}  // namespace hausbench
