// Writes and reads result files (HDF5), which results/README.md documents.
#pragma once

#include "algorithms/error.h"
#include "harness/record/row.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
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

// Thrown if a newer version of this program wrote the file, which this version cannot read.
class NewerResult : public InputError {
public:
    using InputError::InputError;
};

// Reads a result. Throws NewerResult if a newer program wrote it. Throws InputError if the file is missing, not a
// regular file, not HDF5, cut short, or not a result of hausbench.
ResultFile read_result(const std::filesystem::path& file);

// A part of the rows of a result.
struct ResultPart {
    std::set<std::string> columns;  // names of columns of /cases that are not counters, such as "solver"
    bool times = false;             // with /answers, /repeats and /preparation
    bool models = false;            // with /models
};

// Reads the attributes of /meta and a part of the rows. All other members keep their defaults. Faster than
// read_result(), and throws the same.
ResultFile read_part(const std::filesystem::path& file, const ResultPart& part);

// The experiment of an earlier result.
struct EarlierExperiment {
    std::string file, toml;  // the name of the experiment's file, and its text
};

// Returns the experiment stored in a result. If the result is missing or damaged, both members are empty; if an old
// version wrote it, the name is empty. Throws NewerResult if a newer version wrote it.
EarlierExperiment experiment_of(const std::filesystem::path& result);

}  // namespace hausbench
