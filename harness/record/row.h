// The rows of a result file in memory: cases with their outcomes, fields, models and the ledger. columns.h lists the
// columns of the file.
#pragma once

#include "harness/ask/fields.h"
#include "harness/record/outcome.h"

#include <array>
#include <cstdint>
#include <string>

namespace hausbench {

template <> inline constexpr int count_of<Quantity> = 4;
template <> inline constexpr int count_of<WeighBy> = 2;
template <> inline constexpr int count_of<Witness::Direction> = 2;
template <> inline constexpr int count_of<Field::Of> = 3;
template <> inline constexpr int count_of<Field::Meaning> = 3;

// One row of /cases or /references in a result file.
struct Row {
    Case spec;  // what was asked
    Outcome outcome;
    Check check;
    Fields fields = {};                     // empty unless the experiment asks for them
    Bounds reference = {unknown, unknown};  // bounds of the reference answer; NaN: none
    bool is_reference = false;              // this row is itself a reference answer
};

// One row of /fields in a result file: the name and kind of a field. The values of the field are entries [begin, end)
// of /fields/values.
struct FieldRecord {
    std::string name;
    Field::Of of = Field::Of::vertices;
    Field::Meaning meaning = Field::Meaning::number;
    std::int64_t begin = 0, end = 0;
};

inline constexpr std::array<double, 6> no_box{unknown, unknown, unknown, unknown, unknown, unknown};

// One row of /models in a result file. `polynomial` and `box` are set only for an algebraic surface.
struct ModelRecord {
    std::string name, sha256, kind, precision, source, licence, note, polynomial;
    std::int64_t elements = 0, vertices = 0, unreferenced = -1;
    double diagonal = 0, longest_side = 0;
    std::array<double, 6> box = no_box;  // least x, greatest x, then y and z likewise
    std::string path = {}, file_sha256 = {};
};

// One row of /ledger in a result file: work that a run left out, or could not leave out, with the reason; or the cost
// of the reference answers.
struct LedgerEntry {
    std::string kind;  // not_built | not_prepared | not_run | prepared_again | reference
    std::string subject, what, reason;
    std::int64_t count = 1;
    double seconds_saved = unknown;  // known only after the run, and not for every entry
    std::string profile = {};        // with which the experiment was run
};

}  // namespace hausbench
