// Converts numbers, points, poses and parameters to and from JSON.
#pragma once

#include "algorithms/kernel/geometry.h"
#include "algorithms/options.h"

#include <nlohmann/json.hpp>

namespace hausbench {

// Convert a double to and from JSON. JSON has no NaN or infinity, so these become the texts "nan", "inf" and "-inf".
nlohmann::json number(double value);
double number(const nlohmann::json& json);

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
