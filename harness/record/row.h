// The rows of a result file, in memory: cases with their outcomes, models, the ledger. columns.h is the table of the files' columns.
#pragma once

#include "harness/record/fields.h"
#include "harness/record/outcome.h"

#include <array>
#include <cstdint>
#include <string>

namespace hausbench {

template <> inline constexpr int count_of<Quantity> = 3;
template <> inline constexpr int count_of<Witness::Direction> = 2;
template <> inline constexpr int count_of<Field::Of> = 3;
template <> inline constexpr int count_of<Field::Meaning> = 3;

// One row of a result file.
struct Row {
    Case asked;
    Outcome outcome;
    Check check;
    Fields fields = {};                     // where the experiment asks for them
    Bounds reference = {unknown, unknown};  // bounds of the reference answer; NaN: none
    bool is_reference = false;              // it is such an answer itself
};

// One row of /fields: the values of a case's field stand in one piece of the values of all.
struct FieldRecord {
    std::string name;
    Field::Of of = Field::Of::vertices;
    Field::Meaning meaning = Field::Meaning::number;
    std::int64_t begin = 0, end = 0;
};

inline constexpr std::array<double, 6> no_box{unknown, unknown, unknown, unknown, unknown, unknown};

// One row of /models. Only algebraic surfaces have a polynomial and a box.
struct ModelRecord {
    std::string name, sha256, kind, precision, source, licence, note, polynomial;
    std::int64_t elements = 0, vertices = 0, unreferenced = -1;
    double diagonal = 0, longest_side = 0;
    std::array<double, 6> box = no_box;  // from, to in x, y and z
    std::string path = {}, file_sha256 = {};
};

// Work that was left out, and the reason.
struct LedgerEntry {
    std::string kind;  // not_built | not_prepared | not_run | prepared_again
    std::string subject, what, reason;
    std::int64_t count = 1;
    double seconds_saved = unknown;  // known only afterwards, and not for all
    std::string profile = {};        // of the experiment, as run
};

}  // namespace hausbench
