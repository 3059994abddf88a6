// Writes and reads the HDF5 file that results/README.md documents.
#pragma once

#include "algorithms/error.h"
#include "harness/record/row.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace hausbench {

inline constexpr int result_schema = 2;

// Everything in a result file.
struct ResultFile {
    std::map<std::string, std::string> texts;      // attributes of /meta
    std::map<std::string, std::int64_t> integers;  // attributes of /meta
    std::vector<ModelRecord> models;
    std::vector<Row> rows, references;
    std::vector<LedgerEntry> ledger;
};

// Writes the whole file or nothing, through a temporary file and a rename. Throws InputError if it cannot be written.
void write_result(const std::filesystem::path& file, const ResultFile& result);

// Thrown for an intact file that a newer program wrote.
class NewerResult : public InputError {
public:
    using InputError::InputError;
};

// Reads a result. Throws NewerResult, and InputError for a file that is missing, not a regular file, not HDF5, cut
// short, or not a result of hausbench.
ResultFile read_result(const std::filesystem::path& file);

// The experiment of an earlier result.
struct EarlierExperiment {
    std::string file, toml;  // the name of the experiment's file, and its text
};

// Returns the experiment that a result holds. If the result is missing or damaged, both members are empty; if an old
// version wrote it, the name is empty. Throws NewerResult.
EarlierExperiment experiment_of(const std::filesystem::path& result);

}  // namespace hausbench
