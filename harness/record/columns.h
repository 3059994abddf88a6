// The table of all columns of a result file. For each column, it has the name, the meaning, functions that get and set
// the value in a row in memory, and whether the column is part of a case's identity. The writer and the reader of
// result files, the journal and identify() all use this table; `python3 -m analysis.schema` generates the tables in
// results/README.md and analysis/shared/columns.py from it. To add a column, add a member in case.h, outcome.h or row.h
// and a line in column_tables.cpp.
//
// If a file lacks a column, its member keeps its default. Unknown columns are ignored.
#pragma once

#include "harness/record/row.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hausbench {

// When a column is part of a case's identity (a hash).
enum class Identity {
    no,
    always,
    // Only if the model is missing: it has no hash, so its name tells such cases apart.
    of_missing,
    // Only if the value is not the default, so that a column added later leaves the identity of older cases unchanged.
    where_given
};

template <class Row> struct Column {
    struct Text {
        std::string (*get)(const Row&);
        void (*set)(Row&, const std::string&);  // throws std::runtime_error for an illegal value
    };
    struct Real {
        std::size_t width;  // number of doubles per row
        void (*get)(const Row&, double*);
        void (*set)(Row&, const double*);
    };
    struct Integer {
        std::int64_t (*get)(const Row&);
        void (*set)(Row&, std::int64_t);
    };

    std::string_view name, meaning;           // the meaning is Markdown, one line
    std::variant<Text, Real, Integer> value;  // set is null if the value follows from other columns
    Identity identity = Identity::no;
};

template <class Row> using Columns = std::vector<Column<Row>>;

// A row of /cases has the columns of a case, of its outcome and of its check, side by side.
const Columns<Case>& case_columns();
// Excludes the counters, whose columns come from counter_fields (kernel/counters.h).
const Columns<Outcome>& outcome_columns();
const Columns<Check>& check_columns();
const Columns<Row>& row_columns();  // bounds of the reference answer, and errors computed from them
const Columns<ModelRecord>& model_columns();
// Groups with several rows per case. In files, a column `case` with the number of the case comes first. Traces have no
// such column; instead, the case has the columns `trace_begin` and `trace_end`.
const Columns<FirstAnswer>& answer_columns();
const Columns<Repeat>& repeat_columns();
const Columns<Preparation>& preparation_columns();
const Columns<TraceSample>& trace_columns();
const Columns<FieldRecord>& field_columns();

const Columns<LedgerEntry>& ledger_columns();

// Convert a row to and from a JSON object, the form used in the journal of a run.
template <class Row> nlohmann::json row_json(const Columns<Row>& columns, const Row& row);
template <class Row> void read_row(const Columns<Row>& columns, const nlohmann::json& object, Row& row);

// Returns all groups as JSON, with the name, type, width, meaning, default and identity of each
// column: the output of `hausbench list columns`.
nlohmann::json columns_json();

}  // namespace hausbench
