// Merges results of one experiment.
#pragma once

#include "harness/result/result_file.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hausbench {

// One result out of several of the same experiment and profile (shards, or parts): of each case the row that was run, also
// where one of the machines lacked its model or its solver.
// Throws InputError for different experiments, different builds or machines (unless any_build), or two rows of one case
// whose answers differ.
ResultFile merge_results(const std::vector<std::filesystem::path>& files, bool any_build);

// A line that names the shards that a result lacks; empty where no case is left to another shard.
std::string missing_shards(const ResultFile& merged);

}  // namespace hausbench
