// Converts rows and their parts to and from JSON, for journals and for pipes between processes.
#pragma once

#include "harness/record/row.h"

#include <nlohmann/json.hpp>

#include <map>
#include <string>

namespace hausbench {

nlohmann::json to_json(const Outcome& outcome);
Outcome outcome_from_json(const nlohmann::json& json);

// Convert a double to and from JSON. JSON has no NaN or infinity, so these become the texts "nan", "inf" and "-inf".
nlohmann::json number(double value);
double number(const nlohmann::json& json);

nlohmann::json extras_json(const std::map<std::string, double>& extras);
std::map<std::string, double> extras_of(const nlohmann::json& object);

}  // namespace hausbench

namespace nlohmann {

template <> struct adl_serializer<hausbench::ParameterValue> {
    static void to_json(json& j, const hausbench::ParameterValue& value);
    static void from_json(const json& j, hausbench::ParameterValue& value);
};

template <> struct adl_serializer<hausbench::Vec3> {
    static void to_json(json& j, const hausbench::Vec3& point);
    static void from_json(const json& j, hausbench::Vec3& point);
};

// A pose is twelve numbers: the rotation row by row, then the translation.
template <> struct adl_serializer<hausbench::Pose> {
    static void to_json(json& j, const hausbench::Pose& pose);
    static void from_json(const json& j, hausbench::Pose& pose);
};

}  // namespace nlohmann
