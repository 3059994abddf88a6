// Measures many pairs of files with one call of `measure`.
#pragma once

#include "harness/commands/measurement.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace hausbench {

using NamedPairs = std::vector<std::pair<std::string, std::string>>;

// Returns whether a name contains * or ? and is not an existing file.
bool is_pattern(const std::string& name);

// Returns the pairs of files for A and B, at least one of which is a pattern. A plain name belongs to every pair. If
// both are patterns, files with the same name apart from folder and extension are a pair, such as scans/x.ply and
// parts/x.stl; a file without a partner is paired with an empty name. Throws InputError if nothing matches, if no file
// has a partner, or if two files of one side have the same name.
NamedPairs pairs_of_patterns(const std::string& a, const std::string& b);

// Reads a list of pairs, one per line: A, then B, separated by a comma, a tab or blanks. Names may be quoted as in CSV.
// `#` starts a comment at the beginning of a line or after a blank. Relative paths start at the folder of the list.
// Throws InputError with the line number.
NamedPairs read_pairs(const std::filesystem::path& list);

// Measures the pairs and prints one line of CSV for each as soon as it is done (columns: docs/measure.md). If a pair
// cannot be read or lacks a file, its line contains the error. Returns 0 if every pair has exit code 0, otherwise 1.
int measure_pairs(const NamedPairs& pairs, const MeasureRequest& request);

}  // namespace hausbench
