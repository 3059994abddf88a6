#include "harness/ask/json_values.h"

#include <cmath>
#include <limits>

namespace hausbench {

using nlohmann::json;

json number(double value) {
    if (std::isfinite(value)) return value;
    return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}

double number(const json& value) {
    if (value.is_number()) return value.get<double>();
    const auto text = value.get<std::string>();
    if (text == "inf") return std::numeric_limits<double>::infinity();
    if (text == "-inf") return -std::numeric_limits<double>::infinity();
    return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace hausbench

namespace nlohmann {

using hausbench::number, hausbench::ParameterValue, hausbench::Pose, hausbench::Vec3;

void adl_serializer<ParameterValue>::to_json(json& j, const ParameterValue& value) {
    std::visit([&](const auto& v) { j = v; }, value);
}

void adl_serializer<ParameterValue>::from_json(const json& j, ParameterValue& value) {
    if (j.is_boolean())
        value = j.get<bool>();
    else if (j.is_number_integer())
        value = j.get<std::int64_t>();
    else if (j.is_number())
        value = j.get<double>();
    else
        value = j.get<std::string>();
}

void adl_serializer<Vec3>::to_json(json& j, const Vec3& point) {
    j = {number(point[0]), number(point[1]), number(point[2])};
}

void adl_serializer<Vec3>::from_json(const json& j, Vec3& point) {
    for (int i = 0; i < 3; ++i) point[i] = number(j.at(std::size_t(i)));
}

void adl_serializer<Pose>::to_json(json& j, const Pose& pose) {
    j = json::array();
    for (int i = 0; i < 9; ++i) j.push_back(number(pose.rotation(i / 3, i % 3)));
    for (int i = 0; i < 3; ++i) j.push_back(number(pose.translation[i]));
}

void adl_serializer<Pose>::from_json(const json& j, Pose& pose) {
    for (int i = 0; i < 9; ++i) pose.rotation(i / 3, i % 3) = number(j.at(std::size_t(i)));
    for (int i = 0; i < 3; ++i) pose.translation[i] = number(j.at(std::size_t(9 + i)));
}

}  // namespace nlohmann
