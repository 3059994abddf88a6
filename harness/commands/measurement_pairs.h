// Many pairs of files for one `measure`.
#pragma once

#include "harness/commands/measurement.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace hausbench {

using NamedPairs = std::vector<std::pair<std::string, std::string>>;

// Whether a name has * or ?, and is no file.
bool is_pattern(const std::string& name);

// The files that match `a`, each with B: one name, or the file that matches `b` and has the same name without its extension. Where one has
// no partner, that is empty. Throws InputError if nothing matches, or two files have the same name.
NamedPairs pairs_of_patterns(const std::string& a, const std::string& b);

// A line for each pair: A, then B, with a comma, a tab or blanks between, names in quotes as in CSV; `#` at the begin of a line or after a blank begins a comment. Relative paths count from the folder of the
// list. Throws InputError with the line.
NamedPairs read_pairs(const std::filesystem::path& list);

// Measures each pair and prints a line of CSV for it as soon as it is known, with all digits (docs/measure.md has the columns). A pair that cannot be read, or lacks a file, is a line with
// its error, and the others are measured all the same. Returns the exit code: 0 if every pair has exit code 0, else 1.
int measure_pairs(const NamedPairs& pairs, const MeasureRequest& request);

}  // namespace hausbench
