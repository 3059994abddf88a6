// Writes the HDF5 file that results/README.md documents.
#pragma once

#include "plan.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hausbench {

inline constexpr int result_schema = 1;

struct ResultMeta {
    std::string started, finished;
};

// Whole or not at all: by a temporary file and rename. Throws InputError where it cannot be written.
void write_result(const std::filesystem::path& file, const Experiment& experiment, const ResultMeta& meta,
                  const std::vector<Row>& rows, const std::vector<ModelRow>& models, const std::vector<LedgerEntry>& ledger);

}  // namespace hausbench
