// Rows and their parts as JSON, for journals and pipes.
#pragma once

#include "record/row.h"

#include <nlohmann/json.hpp>

namespace hausbench {

nlohmann::json to_json(const Outcome& outcome);
Outcome outcome_from_json(const nlohmann::json& json);

ParameterValue parameter_of(const nlohmann::json& value);
nlohmann::json options_json(const ParameterMap& options);

nlohmann::json extras_json(const std::map<std::string, double>& extras);
std::map<std::string, double> extras_of(const nlohmann::json& object);

// JSON has no NaN or infinity: these become texts.
nlohmann::json number(double value);
double number(const nlohmann::json& json);

// Twelve numbers: the rotation row by row, then the translation.
nlohmann::json pose_json(const Pose& pose);
Pose pose_of(const nlohmann::json& values);

}  // namespace hausbench
