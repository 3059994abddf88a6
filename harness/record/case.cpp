#include "harness/record/case.h"

#include "algorithms/printable.h"
#include "datasets/hash.h"
#include "harness/record/columns.h"

#include <fmt/format.h>

#include <algorithm>

namespace hausbench {

Tolerance Case::resolved_tolerance() const {
    if (tolerance_of == "lower") return {Tolerance::Of::lower, tolerance};
    return {Tolerance::Of::absolute, tolerance_as_length(tolerance, unit())};
}

std::string identify(const Case& spec) {
    Sha256 hash;
    hash.add("case 1").add(spec.source_hash).add(spec.target_hash);
    const Case usual;
    const auto values_of = [](const Column<Case>::Real& real, const Case& row) {
        std::vector<double> values(real.width);
        real.get(row, values.data());
        return values;
    };
    for (const Column<Case>& column : case_columns()) {
        if (column.identity == Identity::no) continue;
        if (column.name == "source" && !spec.source_hash.empty()) continue;
        if (column.name == "target" && !spec.target_hash.empty()) continue;
        const bool later = column.identity == Identity::where_given;
        if (const auto* text = std::get_if<Column<Case>::Text>(&column.value)) {
            if (later && text->get(spec) == text->get(usual)) continue;
            if (later) hash.add(column.name);
            hash.add(text->get(spec));
        } else if (const auto* integer = std::get_if<Column<Case>::Integer>(&column.value)) {
            const std::int64_t value = integer->get(spec);
            if (later && value == integer->get(usual)) continue;
            if (later) hash.add(column.name);
            hash.add(&value, sizeof value);
        } else {
            const auto& real = std::get<Column<Case>::Real>(column.value);
            const std::vector<double> values = values_of(real, spec);
            if (later && values == values_of(real, usual)) continue;
            if (later) hash.add(column.name);
            hash.add(values.data(), values.size() * sizeof(double));
        }
    }
    return hash.hex();
}

std::string shown(const Case& spec) {
    return spec.variant.empty() ? spec.label : fmt::format("{}({})", spec.label, spec.variant);
}

std::string variant_of(const ParameterMap& options, const std::vector<ParameterMap>& swept) {
    std::string text;
    for (const auto& parameter : options) {
        const bool same = std::all_of(swept.begin(), swept.end(), [&](const ParameterMap& other) {
            const auto at = other.find(parameter.first);
            return at != other.end() && at->second == parameter.second;
        });
        if (same) continue;
        text += fmt::format("{}{}={}", text.empty() ? "" : ", ", parameter.first, to_string(parameter.second));
    }
    return text;
}

std::string suffix_of(const Case& spec) {
    switch (spec.quantity) {
        case Quantity::directed:
            return "";
        case Quantity::symmetric:
            return ", H";
        case Quantity::penetration:
            return ", depth";
        case Quantity::distribution:
            return ", " + spec.statistic + (spec.weigh == WeighBy::number ? " by number" : "");
    }
    return "";
}

std::string suffix_of_statistic(const Case& spec) {
    return spec.quantity == Quantity::distribution ? suffix_of(spec) : "";
}

std::string name_of(const Case& c) {
    return printable(fmt::format("{} on {}{}, pose {}, tolerance {:g} of {}{}", shown(c), c.scene, suffix_of(c),
                                 c.pose_index, c.tolerance, c.tolerance_of, c.warm ? ", warm" : ""));
}

}  // namespace hausbench
