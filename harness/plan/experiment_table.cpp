#include "harness/plan/experiment_table.h"

#include <fmt/format.h>

namespace hausbench {

double ExperimentTable::limit(std::string_view key, double otherwise) const {
    // As megabytes, more than any machine has. As seconds, 3 years, which still fits into 64-bit nanoseconds.
    constexpr double most = 1e8;
    const toml::node* node = find(key);
    return node ? positive(*node, key, most) : otherwise;
}

Vec3 ExperimentTable::vector(std::string_view key) const {
    const toml::node& node = required(key);
    const toml::array* array = node.as_array();
    if (!array || array->size() != 3) fail(node, fmt::format("'{}' must be three numbers in brackets", key));
    Vec3 value;
    for (std::size_t i = 0; i < 3; ++i) value[Eigen::Index(i)] = number(*array->get(i), key);
    return value;
}

std::vector<double> ExperimentTable::tolerances(std::string_view key) const {
    std::vector<double> values;
    const toml::node* node = find(key);
    if (!node) return values;
    const toml::array* array = node->as_array();
    if (!array || array->empty()) fail(*node, fmt::format("'{}' must be a list of numbers above 0", key));
    for (const toml::node& item : *array) values.push_back(positive(item, key));
    return values;
}

}  // namespace hausbench
