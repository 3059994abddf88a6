// Converts rows and their parts to and from JSON, for journals and for pipes between processes.
#pragma once

#include "harness/ask/json_values.h"
#include "harness/record/row.h"

#include <nlohmann/json.hpp>

#include <map>
#include <string>

namespace hausbench {

nlohmann::json to_json(const Outcome& outcome);
Outcome outcome_from_json(const nlohmann::json& json);

nlohmann::json extras_json(const std::map<std::string, double>& extras);
std::map<std::string, double> extras_of(const nlohmann::json& object);

}  // namespace hausbench
