#include "harness/result/result_file.h"

#include "algorithms/error.h"
#include "datasets/hdf5.h"
#include "harness/record/columns.h"

#include <fmt/format.h>

#include <set>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

// Writes the columns of a group. `whole` has one entry per row; part(entry) returns the struct that holds the columns,
// such as the outcome of a row.
template <class Row, class Whole, class Part>
void write_columns(h5::File& file, const std::string& group, const Columns<Row>& columns,
                   const std::vector<Whole>& whole, Part part) {
    for (const Column<Row>& column : columns) {
        const std::string name = group + "/" + std::string(column.name);
        if (const auto* text = std::get_if<typename Column<Row>::Text>(&column.value)) {
            std::vector<std::string> values;
            for (const Whole& entry : whole) values.push_back(text->get(part(entry)));
            file.write(name, values);
        } else if (const auto* integer = std::get_if<typename Column<Row>::Integer>(&column.value)) {
            std::vector<std::int64_t> values;
            for (const Whole& entry : whole) values.push_back(integer->get(part(entry)));
            file.write(name, values);
        } else {
            const auto& real = std::get<typename Column<Row>::Real>(column.value);
            std::vector<double> values(whole.size() * real.width);
            for (std::size_t i = 0; i < whole.size(); ++i) real.get(part(whole[i]), values.data() + i * real.width);
            file.write(name, values, real.width);
        }
    }
}

// Writes the columns that /cases and /references share.
void write_answers(h5::File& file, const std::string& group, const std::vector<Row>& rows) {
    write_columns(file, group, case_columns(), rows, [](const Row& r) -> const Case& { return r.spec; });
    write_columns(file, group, outcome_columns(), rows, [](const Row& r) -> const Outcome& { return r.outcome; });
    write_columns(file, group, check_columns(), rows, [](const Row& r) -> const Check& { return r.check; });
}

void write_cases(h5::File& file, const std::vector<Row>& rows) {
    write_answers(file, "cases", rows);
    write_columns(file, "cases", row_columns(), rows, std::identity{});
    std::set<std::string> others;
    for (const Row& row : rows) {
        for (const auto& [name, count] : row.outcome.other_counters) others.insert(name);
    }
    const auto write = [&](std::string_view name, auto count_of) {
        std::vector<std::uint64_t> values;
        for (const Row& row : rows) values.push_back(count_of(row.outcome));
        file.write(fmt::format("cases/counter_{}", name), values);
    };
    for (const CounterField& field : counter_fields)
        write(field.name, [&](const Outcome& o) { return o.counters.*field.member; });
    for (const std::string& name : others) {
        write(name, [&](const Outcome& o) {
            const auto at = o.other_counters.find(name);
            return at == o.other_counters.end() ? 0 : at->second;
        });
    }
}

// Writes a group with several rows per case. Its column `case` holds the number of each row's case.
template <class Detail>
void write_details(h5::File& file, const std::string& group, const Columns<Detail>& columns,
                   const std::vector<Row>& rows, std::vector<Detail> Outcome::*member) {
    std::vector<std::int64_t> of;
    std::vector<Detail> all;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        for (const Detail& detail : rows[i].outcome.*member) {
            of.push_back(std::int64_t(i));
            all.push_back(detail);
        }
    }
    file.write(group + "/case", of);
    write_columns(file, group, columns, all, std::identity{});
}

// Writes all traces one after the other. Each case records where its trace begins and ends.
void write_traces(h5::File& file, const std::vector<Row>& rows) {
    std::vector<std::int64_t> begins, ends;
    std::vector<TraceSample> all;
    for (const Row& row : rows) {
        const auto& trace = row.outcome.trace;
        begins.push_back(std::int64_t(all.size()));
        all.insert(all.end(), trace.begin(), trace.end());
        ends.push_back(std::int64_t(all.size()));
    }
    file.write("cases/trace_begin", begins);
    file.write("cases/trace_end", ends);
    write_columns(file, "trace", trace_columns(), all, std::identity{});
}

void write_fields(h5::File& file, const std::vector<Row>& rows) {
    std::vector<std::int64_t> of;
    std::vector<FieldRecord> all;
    std::vector<double> values;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        for (const Field& field : rows[i].fields) {
            const auto begin = std::int64_t(values.size());
            values.insert(values.end(), field.values.begin(), field.values.end());
            of.push_back(std::int64_t(i));
            all.push_back({field.name, field.of, field.meaning, begin, std::int64_t(values.size())});
        }
    }
    file.write("fields/case", of);
    write_columns(file, "fields", field_columns(), all, std::identity{});
    file.write("fields/values", values);
}

}  // namespace

void write_result(const fs::path& file, const ResultFile& result) {
    const fs::path unfinished = file.string() + ".unfinished";
    try {
        h5::File out(unfinished, h5::Open::create);
        out.attribute("meta", "schema_version", result_schema);
        for (const auto& [name, value] : result.texts) out.attribute("meta", name, value);
        for (const auto& [name, value] : result.integers) out.attribute("meta", name, value);
        write_columns(out, "models", model_columns(), result.models, std::identity{});
        write_cases(out, result.rows);
        write_answers(out, "references", result.references);
        write_details(out, "answers", answer_columns(), result.rows, &Outcome::answers);
        write_details(out, "repeats", repeat_columns(), result.rows, &Outcome::repeats);
        write_details(out, "preparation", preparation_columns(), result.rows, &Outcome::preparation);
        write_traces(out, result.rows);
        write_fields(out, result.rows);
        write_columns(out, "ledger", ledger_columns(), result.ledger, std::identity{});
        out.close();
        fs::rename(unfinished, file);
    } catch (const std::exception& error) {
        std::error_code ignored;
        fs::remove(unfinished, ignored);
        throw InputError(
            fmt::format("{}: cannot write the result: {}; nothing is lost: make room, or choose another folder (for "
                        "`run` with --results), and start again",
                        file.string(), error.what()));
    }
}

}  // namespace hausbench
