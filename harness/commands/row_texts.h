// Formats values of rows for text tables.
#pragma once

#include "harness/commands/text_table.h"
#include "harness/record/row.h"
#include "harness/result/provenance.h"

#include <string>
#include <vector>

namespace hausbench {

// "1.3 ms"; empty for NaN.
std::string duration_text(double seconds);

// Six digits, rounded away from the distance, so that what is shown holds as well.
std::string bound_text(double value, bool lower);

std::string bytes_text(std::int64_t bytes);     // "1.3 MB"; empty where it is unknown, -1
std::string time_text(const Outcome& outcome);  // with its interval, where there is one
// Whether independent code has re-checked the lower bound by its witness.
std::string check_text(const Row& row);
std::string tolerance_text(const Case& asked);  // "0.001 diagonal"
std::string answer_of(const Row& row);          // column `answer`
std::string gap_text(double gap);               // two digits; empty for NaN

// Says for the end of a table which rows have times that do not compare, and why; empty if all compare.
std::string apart_text(const std::vector<const Row*>& rows, const Programs& programs);

// A field of CSV: quoted if it has a comma, a quote or a line break.
std::string csv_field(const std::string& text);

std::string counted(std::size_t count, const std::string& thing);  // "1 answer", "2 answers"

double gap_of(const Outcome& outcome);
Colour colour_of(RowStatus status);

}  // namespace hausbench
