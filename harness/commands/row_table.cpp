#include "harness/commands/row_table.h"

#include "harness/commands/row_texts.h"
#include "harness/record/json.h"
#include "harness/record/row_times.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>

namespace hausbench {

using nlohmann::json;

namespace {

// Returns the values of a row for JSON and CSV, with all digits. The keys, in this order, are also the CSV columns.
nlohmann::ordered_json row_object(const Row& row) {
    const Case& c = row.spec;
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
            {"statistic", c.statistic},
            {"weigh", to_string(c.weigh)},
            {"tolerance", c.tolerance},
            {"tolerance_of", c.tolerance_of},
            {"lower", number(o.bounds.lower)},
            {"upper", number(o.bounds.upper)},
            {"gap", number(gap_of(o))},
            {"answer", answer_of(row)},
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
    const std::string text =
        value.is_string() ? value.get<std::string>() : value.dump(-1, ' ', false, json::error_handler_t::replace);
    return hausbench::csv_field(text);
}

std::string as_csv(const ResultFile& result, const std::vector<std::size_t>& rows) {
    std::vector<std::string> names;
    const auto usual = row_object(Row{});  // a variable, because items() refers to it
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

// Returns the columns to show. Omits pose, tolerance and profile if they are the same in all rows, and `answer` if no
// row stopped at its floor or cutoff.
std::vector<Shown> columns_for(const ResultFile& result, const std::vector<std::size_t>& rows) {
    const auto differ = [&](auto value) {
        return std::any_of(rows.begin(), rows.end(), [&](std::size_t row) {
            return value(result.rows[row]) != value(result.rows[rows.front()]);
        });
    };
    std::vector<Shown> out = {
        {{"solver", false, 0, true}, [](const Row& r) { return shown(r.spec); }},
        {{"scene", false, 0, true}, [](const Row& r) { return r.spec.scene + suffix_of(r.spec); }},
    };
    if (differ([](const Row& r) { return r.spec.pose_index; }))
        out.push_back({{"pose", true}, [](const Row& r) { return std::to_string(r.spec.pose_index); }});
    const bool units = differ([](const Row& r) { return r.spec.tolerance_of; });
    if (differ([](const Row& r) { return tolerance_text(r.spec); }))
        out.push_back({{"tolerance", true}, [units](const Row& r) {
                           return units ? tolerance_text(r.spec) : fmt::format("{:g}", r.spec.tolerance);
                       }});
    if (differ([](const Row& r) { return r.spec.profile; }))
        out.push_back({{"profile", false, 5}, [](const Row& r) { return r.spec.profile; }});
    out.push_back({{"lower", true}, [](const Row& r) { return bound_text(r.outcome.bounds.lower, true); }});
    out.push_back({{"upper", true}, [](const Row& r) { return bound_text(r.outcome.bounds.upper, false); }});
    out.push_back({{"gap", true, 6}, [](const Row& r) { return gap_text(gap_of(r.outcome)); }});
    if (std::any_of(rows.begin(), rows.end(), [&](std::size_t row) {
            const std::string answer = answer_of(result.rows[row]);
            return !answer.empty() && answer != "gap";
        }))
        out.push_back({{"answer", false}, answer_of});
    out.push_back({{"prepare", true, 7}, [](const Row& r) { return duration_text(r.outcome.prepare_seconds); }});
    out.push_back({{"solve [interval]", true, 4}, [](const Row& r) { return time_text(r.outcome); }});
    out.push_back({{"memory", true, 8}, [](const Row& r) { return bytes_text(r.outcome.peak_bytes); }});
    out.push_back({{"check", false, 3}, check_text});
    out.push_back({{"status", false}, [](const Row& r) { return std::string(to_string(r.outcome.status)); }});
    return out;
}

std::string as_text(const ResultFile& result, const std::vector<std::size_t>& rows, const Paper& paper) {
    if (rows.empty()) return "no row matches\n";
    const auto columns = columns_for(result, rows);
    std::vector<TextTable::Column> titles;
    for (const Shown& entry : columns) titles.push_back(entry.column);
    TextTable table(std::move(titles));
    for (const std::size_t number : rows) {
        const Row& row = result.rows[number];
        TextTable::Row line;
        for (const Shown& entry : columns) line.cells.push_back(entry.cell(row));
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
    std::vector<const Row*> timed;
    for (const std::size_t number : rows) timed.push_back(&result.rows[number]);
    if (const std::string apart = apart_text(timed, Programs(result.texts)); !apart.empty())
        out += wrapped(apart, 0, paper.width);
    if (!left.empty())
        out += wrapped(
            fmt::format("left out because the terminal is narrow: {} (see --csv or --json)", fmt::join(left, ", ")), 0,
            paper.width);
    return out;
}

std::string as_markdown(const ResultFile& result, const std::vector<std::size_t>& rows) {
    if (rows.empty()) return "no row matches\n";
    const auto escaped = [](const std::string& raw) {
        std::string text = printable(raw);
        for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
        return text;
    };
    auto columns = columns_for(result, rows);
    columns.push_back({{"reason"}, [](const Row& r) { return r.outcome.reason; }});
    std::string head = "|", line = "|";
    for (const Shown& entry : columns) {
        head += fmt::format(" {} |", entry.column.title);
        line += entry.column.right ? " ---: |" : " --- |";
    }
    std::string out = head + '\n' + line + '\n';
    for (const std::size_t row : rows) {
        out += '|';
        for (const Shown& entry : columns) out += fmt::format(" {} |", escaped(entry.cell(result.rows[row])));
        out += '\n';
    }
    return out;
}

}  // namespace

const ResultPart& shown_part() {
    static const ResultPart part{
        {"solver",        "label",  "variant",   "profile",         "scene",       "pose_index",    "quantity",
         "statistic",     "weigh",  "tolerance", "tolerance_of",    "certified",   "lower",         "upper",
         "solver_status", "status", "reason",    "prepare_seconds", "peak_bytes",  "solve_seconds", "clock",
         "side_by_side",  "build",  "machine",   "lower_check",     "upper_check", "fields_check"},
        true};
    return part;
}

std::string show_rows(const ResultFile& result, const std::vector<std::size_t>& rows, TableForm form,
                      const Paper& paper) {
    switch (form) {
        case TableForm::csv:
            return as_csv(result, rows);
        case TableForm::json:
            return as_json(result, rows);
        case TableForm::markdown:
            return as_markdown(result, rows);
        case TableForm::text:
            break;
    }
    return as_text(result, rows, paper);
}

}  // namespace hausbench
