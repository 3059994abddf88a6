#include "harness/record/columns.h"

#include "harness/record/json.h"

namespace hausbench {

using nlohmann::json;

template <class Row> json row_json(const Columns<Row>& columns, const Row& row) {
    json object = json::object();
    for (const Column<Row>& column : columns) {
        json& field = object[std::string(column.name)];
        if (const auto* text = std::get_if<typename Column<Row>::Text>(&column.value)) {
            field = text->get(row);
        } else if (const auto* integer = std::get_if<typename Column<Row>::Integer>(&column.value)) {
            field = integer->get(row);
        } else {
            const auto& real = std::get<typename Column<Row>::Real>(column.value);
            double values[12];
            real.get(row, values);
            if (real.width == 1)
                field = number(values[0]);
            else
                for (std::size_t k = 0; k < real.width; ++k) field.push_back(number(values[k]));
        }
    }
    return object;
}

template <class Row> void read_row(const Columns<Row>& columns, const json& object, Row& row) {
    for (const Column<Row>& column : columns) {
        const auto at = object.find(column.name);
        if (at == object.end()) continue;
        if (const auto* text = std::get_if<typename Column<Row>::Text>(&column.value)) {
            if (text->set) text->set(row, at->template get<std::string>());
        } else if (const auto* integer = std::get_if<typename Column<Row>::Integer>(&column.value)) {
            if (!at->is_number_integer())  // converting another number may overflow, which is undefined
                throw std::runtime_error(std::string(column.name) + " is not an integer");
            if (integer->set) integer->set(row, at->template get<std::int64_t>());
        } else {
            const auto& real = std::get<typename Column<Row>::Real>(column.value);
            double values[12];
            for (std::size_t k = 0; k < real.width; ++k) values[k] = number(real.width == 1 ? *at : at->at(k));
            if (real.set) real.set(row, values);
        }
    }
}

template json row_json(const Columns<Case>&, const Case&);
template json row_json(const Columns<Outcome>&, const Outcome&);
template json row_json(const Columns<FirstAnswer>&, const FirstAnswer&);
template json row_json(const Columns<Repeat>&, const Repeat&);
template json row_json(const Columns<Preparation>&, const Preparation&);
template json row_json(const Columns<TraceSample>&, const TraceSample&);
template json row_json(const Columns<Check>&, const Check&);
template json row_json(const Columns<FieldRecord>&, const FieldRecord&);
template json row_json(const Columns<ModelRecord>&, const ModelRecord&);
template json row_json(const Columns<LedgerEntry>&, const LedgerEntry&);
template void read_row(const Columns<Outcome>&, const json&, Outcome&);
template void read_row(const Columns<FirstAnswer>&, const json&, FirstAnswer&);
template void read_row(const Columns<Repeat>&, const json&, Repeat&);
template void read_row(const Columns<Preparation>&, const json&, Preparation&);
template void read_row(const Columns<TraceSample>&, const json&, TraceSample&);

namespace {

template <class Row> void describe(const Columns<Row>& columns, json& group) {
    const json usual = row_json(columns, Row{});
    for (const Column<Row>& column : columns) {
        const auto* real = std::get_if<typename Column<Row>::Real>(&column.value);
        const bool text = std::holds_alternative<typename Column<Row>::Text>(column.value);
        group.push_back({{"name", column.name},
                         {"type", real   ? "real"
                                  : text ? "text"
                                         : "integer"},
                         {"width", real ? real->width : 1},
                         {"meaning", column.meaning},
                         {"default", usual.at(std::string(column.name))},
                         {"identity", column.identity != Identity::no}});
    }
}

}  // namespace

json columns_json() {
    const auto integer = [](const char* name, const char* meaning) {
        return json{{"name", name},       {"type", "integer"}, {"width", 1},
                    {"meaning", meaning}, {"default", 0},      {"identity", false}};
    };
    json groups = json::object();
    describe(model_columns(), groups["models"]);
    json& cases = groups["cases"];
    describe(case_columns(), cases);
    describe(outcome_columns(), cases);
    cases.push_back(integer("trace_begin", "first row in `/trace`"));
    cases.push_back(integer("trace_end", "the row after the last; equal to `trace_begin` where there is none"));
    cases.push_back({{"name", "counter_*"},
                     {"type", "count"},
                     {"width", 1},
                     {"meaning", "work counters of one solve"},
                     {"default", 0},
                     {"identity", false}});
    describe(check_columns(), cases);
    describe(row_columns(), cases);
    for (const char* name : {"answers", "repeats", "preparation", "fields"})
        groups[name].push_back(integer("case", "row of `/cases`"));
    describe(answer_columns(), groups["answers"]);
    describe(repeat_columns(), groups["repeats"]);
    describe(preparation_columns(), groups["preparation"]);
    describe(trace_columns(), groups["trace"]);
    describe(field_columns(), groups["fields"]);
    describe(ledger_columns(), groups["ledger"]);
    return groups;
}

}  // namespace hausbench
