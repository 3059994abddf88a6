// Formats values of rows for text tables.
#pragma once

#include "harness/commands/text_table.h"
#include "harness/record/row.h"
#include "harness/result/provenance.h"

#include <string>
#include <vector>

namespace hausbench {

// Returns a duration as text, such as "1.3 ms", or an empty string if it is not finite.
std::string duration_text(double seconds);

// Returns a bound with `digits` significant digits. Rounds lower bounds down and upper bounds up, so that the shown bound holds, too.
std::string bound_text(double value, bool lower, int digits = 6);

std::string bytes_text(std::int64_t bytes);     // "1.3 MB"; empty if unknown (-1)
std::string time_text(const Outcome& outcome);  // "1.3 ms [1.2 ms, 1.5 ms]": with its interval, if there is one
// Returns the result of checking the row: "unsound" if a bound or a field is refuted, "holds" if the witness proves the
// lower bound, otherwise "not checked". Returns an empty string if the row has no bounds.
std::string check_text(const Row& row);
std::string tolerance_text(const Case& spec);  // "0.001 diagonal"
std::string answer_of(const Row& row);         // the column `answer`, such as "gap"
std::string gap_text(double gap);              // two digits; empty for NaN

// Returns a note that says why not all times of the rows are comparable, or an empty string if they are.
std::string apart_text(const std::vector<const Row*>& rows, const Programs& programs);

// Returns a field of CSV, quoted if it contains a comma, a quote or a line break. A text that a spreadsheet would take
// for a formula, because it begins with = + - or @ and is no number, gets an apostrophe.
std::string csv_field(std::string text);

std::string counted(std::size_t count, const std::string& thing);  // "1 answer", "2 answers"

double gap_of(const Outcome& outcome);
Colour colour_of(RowStatus status);

}  // namespace hausbench
