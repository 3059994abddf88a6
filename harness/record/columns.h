// The one table of the content of result files: the columns of each group, with name, meaning, place of the value,
// and whether it is part of a case's identity. The writer and the reader of result files, the journal and identify()
// follow from it, and so do the tables in results/README.md and analysis/shared/columns.py (`python3 -m
// analysis.schema` writes both). A new column is a member in case.h, outcome.h or row.h and a line in
// column_tables.cpp.
//
// A file may lack a column, which then holds the default of its member, and may hold columns that this program does not know.
#pragma once

#include "harness/record/row.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hausbench {

enum class Identity {
    no,
    always,
    // The name of a missing model, which has no hash, so that such cases differ.
    of_missing,
    // Only if it is not the default: a later column leaves the identity of older cases unchanged.
    where_given
};

template <class Row> struct Column {
    struct Text {
        std::string (*get)(const Row&);
        void (*set)(Row&, const std::string&);  // throws std::runtime_error for an illegal value
    };
    struct Real {
        std::size_t width;
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

// A row of /cases is a case, its outcome and its check side by side.
const Columns<Case>& case_columns();
// Without the counters, whose columns follow from counter_fields.
const Columns<Outcome>& outcome_columns();
const Columns<Check>& check_columns();
const Columns<Row>& row_columns();  // what follows from all of these and the reference answer
const Columns<ModelRecord>& model_columns();
// Several rows a case: in files with the number of the case, in a column `case` before them.
const Columns<FirstAnswer>& answer_columns();
const Columns<Repeat>& repeat_columns();
const Columns<Preparation>& preparation_columns();
const Columns<TraceSample>& trace_columns();
const Columns<FieldRecord>& field_columns();
const Columns<LedgerEntry>& ledger_columns();

// One object a row, as journals have it.
template <class Row> nlohmann::json row_json(const Columns<Row>& columns, const Row& row);
template <class Row> void read_row(const Columns<Row>& columns, const nlohmann::json& object, Row& row);

// All groups with name, type, width, meaning and part in the identity: what `hausbench list columns` prints.
nlohmann::json columns_json();

}  // namespace hausbench
