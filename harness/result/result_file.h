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

// Throws NewerResult, and InputError for a file that is missing, not a regular file, not HDF5,
// cut short, or not a result of hausbench.
ResultFile read_result(const std::filesystem::path& file);

// The experiment of an earlier result: the name of its file and its text. For a missing or damaged
// file both are empty; for a file of an old version the name is empty. Throws NewerResult.
struct EarlierExperiment {
    std::string file, toml;
};
EarlierExperiment experiment_of(const std::filesystem::path& result);

}  // namespace hausbench
