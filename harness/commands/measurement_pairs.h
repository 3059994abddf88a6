// Measures many pairs of files with one `measure`.
#pragma once

#include "harness/commands/measurement.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace hausbench {

using NamedPairs = std::vector<std::pair<std::string, std::string>>;

// Returns whether a name contains * or ? and is not a file.
bool is_pattern(const std::string& name);

// Returns the files that match `a`, each paired with B: one name, or the file that matches `b` and has the same name
// without extension. A file without a partner is paired with an empty name. Throws InputError if nothing matches, or
// if two files have the same name.
NamedPairs pairs_of_patterns(const std::string& a, const std::string& b);

// Reads a list of pairs with one pair per line: A, then B, separated by a comma, a tab or blanks; names may be quoted
// as in CSV. `#` at the beginning of a line or after a blank starts a comment. Relative paths count from the folder
// of the list. Throws InputError with the line.
NamedPairs read_pairs(const std::filesystem::path& list);

// Measures each pair and prints its line of CSV, with all digits, as soon as it is known (docs/measure.md describes
// the columns). A pair that cannot be read or lacks a file gets a line with the error, and the others are still
// measured. Returns the exit code: 0 if every pair has exit code 0, otherwise 1.
int measure_pairs(const NamedPairs& pairs, const MeasureRequest& request);

}  // namespace hausbench
