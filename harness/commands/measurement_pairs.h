// Measures many pairs of files with one call of `measure`.
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

// Returns pairs of files for A and B, of which at least one is a pattern; a plain name belongs to every pair. If both
// are patterns, files with the same name but for folder and extension are a pair, such as scans/x.ply and parts/x.stl,
// and a file without a partner is paired with an empty name. Throws InputError if nothing matches, if no file has a
// partner, or if two files of one side have the same name.
NamedPairs pairs_of_patterns(const std::string& a, const std::string& b);

// Reads a list of pairs with one pair per line: A, then B, separated by a comma, a tab or blanks; names may be quoted
// as in CSV. `#` at the beginning of a line or after a blank starts a comment. Relative paths are relative to the
// folder of the list. Throws InputError that names the line.
NamedPairs read_pairs(const std::filesystem::path& list);

// Measures each pair and prints its line of CSV, with all digits, as soon as it is known (docs/measure.md describes
// the columns). A pair that cannot be read or lacks a file gets a line with the error, and the others are still
// measured. Returns the exit code: 0 if every pair has exit code 0, otherwise 1.
int measure_pairs(const NamedPairs& pairs, const MeasureRequest& request);

}  // namespace hausbench
