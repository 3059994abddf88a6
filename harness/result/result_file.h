// Writes and reads the HDF5 file that results/README.md documents.
#pragma once

#include "record/row.h"

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
    std::map<std::string, std::int64_t> integers;  // likewise
    std::vector<ModelRecord> models;
    std::vector<Row> rows;
    std::vector<LedgerEntry> ledger;
};

// Whole or not at all: by a temporary file and rename. Throws InputError where it cannot be written.
void write_result(const std::filesystem::path& file, const ResultFile& result);

// Throws InputError for a file that is missing, not HDF5, cut short, not a result of hausbench, or of a newer schema.
ResultFile read_result(const std::filesystem::path& file);

}  // namespace hausbench
