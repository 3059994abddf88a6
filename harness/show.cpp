#include "show.h"

#include "row_times.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <regex>
#include <set>

namespace hausbench {

using nlohmann::json;

namespace {

// Six digits, rounded away from the distance, so that what is shown holds as well.
std::string bound_text(double value, bool lower) {
    if (!std::isfinite(value)) return std::isnan(value) ? "" : "inf";
    const auto read = [](const std::string& text) { return std::strtod(text.c_str(), nullptr); };  // stod() throws
    std::string text = fmt::format("{:.5e}", value);                                               // for tiny numbers
    const double shown = read(text);
    if (lower ? shown > value : shown < value) {
        const double step = std::pow(10, std::stoi(text.substr(text.find('e') + 1)) - 5);
        text = fmt::format("{:.5e}", shown + (lower ? -step : step));
    }
    return fmt::format("{:g}", read(text));
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

// Whether independent code has re-checked the lower bound by its witness.
std::string checked_text(const Check& check) {
    if (check.lower == Verdict::unsound || check.upper == Verdict::unsound || check.fields == Verdict::unsound)
        return "unsound";
    return check.lower == Verdict::holds ? "holds" : "not checked";
}

std::string check_text(const Row& row) { return std::isnan(row.outcome.bounds.lower) ? "" : checked_text(row.check); }

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

double gap_of(const Outcome& outcome) { return outcome.bounds.upper - outcome.bounds.lower; }

// What programs get, with all digits; its names, in this order, are also those of the columns of CSV.
nlohmann::ordered_json row_object(const Row& row) {
    const Case& c = row.asked;
    const Outcome& o = row.outcome;
    const Estimate time = time_of(o);
    const bool timed = time.n > 0;
    return {{"solver", c.solver},
            {"label", c.label},
            {"variant", c.variant},
            {"profile", c.profile},
            {"scene", c.scene},
            {"pose", c.pose_index},
            {"quantity", to_string(c.quantity)},
            {"tolerance", c.tolerance},
            {"tolerance_of", c.tolerance_of},
            {"lower", number(o.bounds.lower)},
            {"upper", number(o.bounds.upper)},
            {"gap", number(gap_of(o))},
            {"check", check_text(row)},
            {"certified", c.certified},
            {"prepare_seconds", number(o.prepare_seconds)},
            {"solve_seconds", number(timed ? time.value : unknown)},
            {"solve_seconds_low", number(timed ? time.low : unknown)},
            {"solve_seconds_high", number(timed ? time.high : unknown)},
            {"confidence", time.confidence},
            {"times", time.n},
            {"clock", o.clock},
            {"peak_bytes", o.peak_bytes},
            {"status", to_string(o.status)},
            {"reason", o.reason}};
}

std::string csv_field(const nlohmann::ordered_json& value) {
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + '"';
}

std::string as_csv(const ResultFile& result, const std::vector<std::size_t>& rows) {
    std::vector<std::string> names;
    const auto usual = row_object(Row{});  // outlives its items()
    for (const auto& [name, value] : usual.items()) names.push_back(name);
    std::string out = fmt::format("{}\n", fmt::join(names, ","));
    for (const std::size_t row : rows) {
        std::vector<std::string> fields;
        const auto values = row_object(result.rows[row]);
        for (const auto& value : values) fields.push_back(csv_field(value));
        out += fmt::format("{}\n", fmt::join(fields, ","));
    }
    return out;
}

std::string as_json(const ResultFile& result, const std::vector<std::size_t>& rows) {
    nlohmann::ordered_json out = {{"stem", result.texts.at("stem")},
                                  {"profile", result.texts.at("profile")},
                                  {"rows", nlohmann::ordered_json::array()}};
    for (const std::size_t row : rows) out["rows"].push_back(row_object(result.rows[row]));
    return out.dump(1, ' ', false, json::error_handler_t::replace) + '\n';
}

struct Shown {
    TextTable::Column column;
    std::function<std::string(const Row&)> cell;
};

// Columns that would hold the same in every row say nothing, so some are shown only where their rows differ.
std::vector<Shown> columns_for(const ResultFile& result, const std::vector<std::size_t>& rows) {
    const auto differ = [&](auto value) {
        return std::any_of(rows.begin(), rows.end(), [&](std::size_t row) {
            return value(result.rows[row]) != value(result.rows[rows.front()]);
        });
    };
    std::vector<Shown> out = {
        {{"solver", false, 0, true}, [](const Row& r) { return shown(r.asked); }},
        {{"scene", false, 0, true}, [](const Row& r) { return r.asked.scene + suffix_of(r.asked.quantity); }},
    };
    if (differ([](const Row& r) { return r.asked.pose_index; }))
        out.push_back({{"pose", true}, [](const Row& r) { return std::to_string(r.asked.pose_index); }});
    const bool units = differ([](const Row& r) { return r.asked.tolerance_of; });
    if (differ([](const Row& r) { return tolerance_text(r.asked); }))
        out.push_back({{"tolerance", true}, [units](const Row& r) {
                           return units ? tolerance_text(r.asked) : fmt::format("{:g}", r.asked.tolerance);
                       }});
    if (differ([](const Row& r) { return r.asked.profile; }))
        out.push_back({{"profile", false, 5}, [](const Row& r) { return r.asked.profile; }});
    out.push_back({{"lower", true}, [](const Row& r) { return bound_text(r.outcome.bounds.lower, true); }});
    out.push_back({{"upper", true}, [](const Row& r) { return bound_text(r.outcome.bounds.upper, false); }});
    out.push_back({{"gap", true, 6}, [](const Row& r) {
                       const double gap = gap_of(r.outcome);
                       return std::isnan(gap) ? "" : fmt::format("{:.2g}", gap);
                   }});
    out.push_back({{"prepare", true, 7}, [](const Row& r) { return duration_text(r.outcome.prepare_seconds); }});
    out.push_back({{"solve [interval]", true, 4}, [](const Row& r) { return time_text(r.outcome); }});
    out.push_back({{"memory", true, 8}, [](const Row& r) { return bytes_text(r.outcome.peak_bytes); }});
    out.push_back({{"check", false, 3}, check_text});
    out.push_back({{"status", false}, [](const Row& r) { return std::string(to_string(r.outcome.status)); }});
    return out;
}

std::string as_text(const ResultFile& result, const std::vector<std::size_t>& rows, const Paper& paper) {
    if (rows.empty()) return "no row is like that\n";
    const auto columns = columns_for(result, rows);
    std::vector<TextTable::Column> titles;
    for (const Shown& one : columns) titles.push_back(one.column);
    TextTable table(std::move(titles));
    for (const std::size_t number : rows) {
        const Row& row = result.rows[number];
        TextTable::Row line;
        for (const Shown& one : columns) line.cells.push_back(one.cell(row));
        if (row.outcome.status != RowStatus::ok) line.below = row.outcome.reason;
        line.colour = colour_of(row.outcome.status);
        table.add(std::move(line));
    }
    std::vector<std::string> left;
    std::string out = table.text(paper, &left);
    std::map<RowStatus, std::size_t> counts;
    for (const std::size_t number : rows) ++counts[result.rows[number].outcome.status];
    out +=
        wrapped(fmt::format("{} of {} rows: {}", rows.size(), result.rows.size(), to_string(counts)), 0, paper.width);
    if (!left.empty())
        out += wrapped(fmt::format("left out for want of room: {} (see --csv or --json)", fmt::join(left, ", ")), 0,
                       paper.width);
    return out;
}

std::string as_markdown(const ResultFile& result, const std::vector<std::size_t>& rows) {
    if (rows.empty()) return "no row is like that\n";
    const auto escaped = [](const std::string& raw) {
        std::string text = printable(raw);
        for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
        return text;
    };
    auto columns = columns_for(result, rows);
    columns.push_back({{"reason"}, [](const Row& r) { return r.outcome.reason; }});
    std::string head = "|", line = "|";
    for (const Shown& one : columns) {
        head += fmt::format(" {} |", one.column.title);
        line += one.column.right ? " ---: |" : " --- |";
    }
    std::string out = head + '\n' + line + '\n';
    for (const std::size_t row : rows) {
        out += '|';
        for (const Shown& one : columns) out += fmt::format(" {} |", escaped(one.cell(result.rows[row])));
        out += '\n';
    }
    return out;
}

}  // namespace

std::string duration_text(double seconds) {
    if (!std::isfinite(seconds)) return "";
    // 999.5 of a unit is 1e+03 in three digits.
    return seconds < 999.5e-6   ? fmt::format("{:.3g} µs", seconds * 1e6)
           : seconds < 999.5e-3 ? fmt::format("{:.3g} ms", seconds * 1e3)
           : seconds < 999.5    ? fmt::format("{:.3g} s", seconds)
                                : fmt::format("{:.0f} s", seconds);
}

SummaryNames::SummaryNames(const std::vector<Row>& rows) {
    for (const Row& row : rows) variants_[row.asked.label].insert(row.asked.variant);
}

std::string SummaryNames::of(const Case& asked) const {
    constexpr std::size_t most = 8;
    const std::size_t count = variants_.at(asked.label).size();
    return count > most ? fmt::format("{}({} variants)", asked.label, count) : shown(asked);
}

std::string count_statuses(const std::vector<Row>& rows) {
    std::map<RowStatus, std::size_t> counts;
    for (const Row& row : rows) ++counts[row.outcome.status];
    return to_string(counts);
}

std::string show_rows(const ResultFile& result, const std::vector<std::size_t>& rows, Form form, const Paper& paper) {
    switch (form) {
        case Form::csv:
            return as_csv(result, rows);
        case Form::json:
            return as_json(result, rows);
        case Form::markdown:
            return as_markdown(result, rows);
        case Form::text:
            break;
    }
    return as_text(result, rows, paper);
}

namespace {

// The text with every number as one sign: reasons that differ in their numbers alone are one.
std::string without_numbers(const std::string& text) {
    static const std::regex number(R"([-+]?\d[\d.]*(e[-+]?\d+)?)");
    return std::regex_replace(text, number, "#");
}

// Rows that have the same key, in the order of the first of each.
class Groups {
public:
    void add(const std::string& key, const Row& row) {
        const auto [at, fresh] = number_.emplace(key, groups_.size());
        if (fresh) groups_.emplace_back();
        groups_[at->second].push_back(&row);
    }
    const std::vector<std::vector<const Row*>>& all() const { return groups_; }

private:
    std::map<std::string, std::size_t> number_;
    std::vector<std::vector<const Row*>> groups_;
};

TextTable::Row summary_line(const std::string& name, const std::vector<const Row*>& rows) {
    std::map<RowStatus, std::size_t> counts;
    std::vector<double> times;
    double gap = unknown;
    Colour colour = Colour::none;
    for (const Row* row : rows) {
        ++counts[row->outcome.status];
        if (const Estimate time = time_of(row->outcome); time.n > 0) times.push_back(time.value);
        gap = std::fmax(gap, gap_of(row->outcome));
        if (row->outcome.status != RowStatus::ok) colour = colour_of(row->outcome.status);
    }
    return {
        {name, std::to_string(rows.size()), to_string(counts), times.empty() ? "" : duration_text(median(times).value),
         std::isnan(gap) ? "" : fmt::format("{:.2g}", gap)},
        "",
        colour};
}

}  // namespace

std::string show_summary(const ResultFile& result, const Paper& paper) {
    const SummaryNames names(result.rows);
    Groups solvers, reasons;
    for (const Row& row : result.rows) {
        solvers.add(names.of(row.asked), row);
        if (row.outcome.status != RowStatus::ok)
            reasons.add(fmt::format("{} {} {}", row.asked.label, to_string(row.outcome.status),
                                    without_numbers(row.outcome.reason)),
                        row);
    }
    TextTable table({{"solver", false, 0, true},
                     {"rows", true},
                     {"status", false, 0, true},
                     {"median solve", true, 1},
                     {"largest gap", true, 2}});
    for (const auto& rows : solvers.all()) table.add(summary_line(names.of(rows.front()->asked), rows));
    std::string out = table.text(paper);
    for (const auto& rows : reasons.all()) {
        const Row& first = *rows.front();
        const std::string where = fmt::format("{}, pose {}, tolerance {:g}", first.asked.scene, first.asked.pose_index,
                                              first.asked.tolerance);
        const std::string which =
            rows.size() == 1 ? where : fmt::format("{} rows like this; the first: {}", rows.size(), where);
        out += wrapped(fmt::format("{}: {}: {} ({})", rows.size() == 1 ? shown(first.asked) : first.asked.label,
                                   to_string(first.outcome.status), first.outcome.reason, which),
                       0, paper.width);
    }
    return out;
}

}  // namespace hausbench
