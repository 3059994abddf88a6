#include "harness/record/json.h"

#include "harness/record/columns.h"

namespace hausbench {

using nlohmann::json;

json extras_json(const std::map<std::string, double>& extras) {
    json object = json::object();
    for (const auto& [name, value] : extras) object[name] = number(value);
    return object;
}

std::map<std::string, double> extras_of(const json& object) {
    std::map<std::string, double> extras;
    for (const auto& [name, value] : object.items()) extras[name] = number(value);
    return extras;
}

namespace {

// Returns an object with one array per column, which is shorter than one object per row.
template <class Row> json rows_json(const Columns<Row>& columns, const std::vector<Row>& rows) {
    json out = json::object();
    for (const Row& row : rows) {
        const json cells = row_json(columns, row);  // a variable, because items() refers to it
        for (const auto& [name, value] : cells.items()) out[name].push_back(value);
    }
    return out;
}

template <class Row> std::vector<Row> rows_of(const Columns<Row>& columns, const json& arrays) {
    std::size_t count = 0;
    for (const auto& [name, values] : arrays.items()) count = values.size();
    std::vector<Row> rows(count);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        json cells = json::object();
        for (const auto& [name, values] : arrays.items()) cells[name] = values.at(i);
        read_row(columns, cells, rows[i]);
    }
    return rows;
}

}  // namespace

json to_json(const Outcome& o) {
    json out = row_json(outcome_columns(), o);
    json& counters = out["counters"] = json::object();
    for (const CounterField& field : counter_fields) counters[std::string(field.name)] = o.counters.*field.member;
    out["answers"] = rows_json(answer_columns(), o.answers);
    out["preparation"] = rows_json(preparation_columns(), o.preparation);
    out["repeats"] = rows_json(repeat_columns(), o.repeats);
    out["repeats_asked"] = o.repeats_asked;
    out["stages_asked"] = o.stages_asked;
    out["trace"] = rows_json(trace_columns(), o.trace);
    return out;
}

namespace {

// Returns the value, but throws if it is not an integer: converting another number may overflow, which is undefined.
const json& whole(const json& value) {
    if (!value.is_number_integer()) throw std::runtime_error("a count is not an integer");
    return value;
}

}  // namespace

Outcome outcome_from_json(const json& j) {
    Outcome o;
    j.at("status");  // throws if there is none
    read_row(outcome_columns(), j, o);
    for (const CounterField& field : counter_fields)
        o.counters.*field.member = whole(j.at("counters").at(std::string(field.name)));
    o.answers = rows_of(answer_columns(), j.at("answers"));
    o.preparation = rows_of(preparation_columns(), j.at("preparation"));
    o.repeats = rows_of(repeat_columns(), j.at("repeats"));
    o.repeats_asked = whole(j.at("repeats_asked"));
    o.stages_asked = j.value("stages_asked", false);
    o.trace = rows_of(trace_columns(), j.at("trace"));
    return o;
}

}  // namespace hausbench
