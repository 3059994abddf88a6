// What is done with finished result files: verify, merge.
#pragma once

#include "catalogue.h"
#include "result_file.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hausbench {

// Re-checks every row (verify.h) on the shapes of the catalogue, which must be those that were measured (SHA-256).
// Returns a line for each model that is not available, whose rows become `not checked`, whatever the file says of them. Throws
// InputError where a model has other bytes now.
std::vector<std::string> verify_result(ResultFile& result, const Catalogue& catalogue);

// A table: how many rows of each solver hold, are unsound, have no witness or were not checked; then each unsound row.
std::string describe_checks(const ResultFile& result);
bool any_unsound(const ResultFile& result);

// One result out of several of the same experiment and profile (shards, or parts): of each case the row that was run, also
// where one of the machines lacked its model or its solver.
// Throws InputError for different experiments, different builds or machines (unless any_build), or two rows of one case
// whose answers differ.
ResultFile merge_results(const std::vector<std::filesystem::path>& files, bool any_build);

// A line that names the shards that a result lacks; empty where no case is left to another shard.
std::string missing_shards(const ResultFile& merged);

}  // namespace hausbench
