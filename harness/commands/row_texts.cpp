#include "harness/commands/row_texts.h"

#include "harness/record/columns.h"
#include "harness/record/row_times.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <optional>
#include <set>

namespace hausbench {

std::string duration_text(double seconds) {
    if (!std::isfinite(seconds)) return "";
    // Switches to the next unit at 999.5, because three digits would give "1e+03".
    return seconds < 999.5e-6   ? fmt::format("{:.3g} µs", seconds * 1e6)
           : seconds < 999.5e-3 ? fmt::format("{:.3g} ms", seconds * 1e3)
           : seconds < 999.5    ? fmt::format("{:.3g} s", seconds)
                                : fmt::format("{:.0f} s", seconds);
}

std::string bound_text(double value, bool lower, int digits) {
    if (!std::isfinite(value)) return std::isnan(value) ? "" : "inf";
    // stod() would throw for subnormal numbers.
    const auto read = [](const std::string& text) { return std::strtod(text.c_str(), nullptr); };
    const auto holds = [&](double shown) { return lower ? shown <= value : shown >= value; };
    const std::string text = fmt::format("{:.{}e}", value, digits - 1);
    double shown = read(text);
    if (!holds(shown)) {
        const double step = std::pow(10, std::stoi(text.substr(text.find('e') + 1)) + 1 - digits);
        shown = read(fmt::format("{:.{}e}", shown + (lower ? -step : step), digits - 1));
    }
    return holds(shown) ? fmt::format("{:.{}g}", shown, digits) : fmt::format("{}", value);
}

std::string bytes_text(std::int64_t bytes) {
    return bytes < 0             ? ""
           : bytes < 999'500'000 ? fmt::format("{:.3g} MB", double(bytes) / 1e6)
                                 : fmt::format("{:.3g} GB", double(bytes) / 1e9);
}

std::string time_text(const Outcome& outcome) {
    const Estimate time = time_of(outcome);
    if (time.n == 0) return "";
    if (time.n == 1) return duration_text(time.value);
    return fmt::format("{} [{}, {}]", duration_text(time.value), duration_text(time.low), duration_text(time.high));
}

std::string check_text(const Row& row) {
    if (std::isnan(row.outcome.bounds.lower)) return "";
    const Check& check = row.check;
    if (check.lower == Verdict::unsound || check.upper == Verdict::unsound || check.fields == Verdict::unsound)
        return "unsound";
    return check.lower == Verdict::holds ? "holds" : "not checked";
}

std::string tolerance_text(const Case& c) { return fmt::format("{:g} {}", c.tolerance, c.tolerance_of); }

Colour colour_of(RowStatus status) {
    switch (status) {
        case RowStatus::ok:
            return Colour::none;
        case RowStatus::skipped:
        case RowStatus::not_built:
            return Colour::grey;
        case RowStatus::timeout:
        case RowStatus::floor:
        case RowStatus::budget:
            return Colour::yellow;
        default:
            return Colour::red;
    }
}

std::string apart_text(const std::vector<const Row*>& rows, const Programs& programs) {
    std::set<std::string> reasons;
    std::optional<Origin> first;
    for (const Row* row : rows) {
        if (time_of(row->outcome).n == 0) continue;
        const Origin origin = origin_of(row->outcome, programs.of(row->outcome.build));
        if (!first) first = origin;
        if (std::string why = reason_apart(*first, origin); !why.empty()) reasons.insert(std::move(why));
    }
    return reasons.empty()
               ? ""
               : fmt::format("not all of these times are comparable: some are {}", fmt::join(reasons, ", "));
}

std::string csv_field(std::string text) {
    if (text.find_first_of("=+-@") == 0) {
        char* end = nullptr;
        std::strtod(text.c_str(), &end);
        if (*end != '\0' || end == text.c_str()) text.insert(0, 1, '\'');
    }
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + '"';
}

double gap_of(const Outcome& outcome) { return outcome.bounds.upper - outcome.bounds.lower; }

std::string answer_of(const Row& row) {
    for (const Column<Outcome>& column : outcome_columns()) {
        if (column.name == "answer") return std::get<Column<Outcome>::Text>(column.value).get(row.outcome);
    }
    return "";
}

std::string counted(std::size_t count, const std::string& thing) {
    return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

std::string gap_text(double gap) { return std::isnan(gap) ? "" : fmt::format("{:.2g}", gap); }

}  // namespace hausbench
