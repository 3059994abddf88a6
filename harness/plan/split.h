// Distributes the jobs of a plan over shards (shard.h), so that all shards are expected to take about equally long.
#pragma once

#include "harness/plan/estimate.h"
#include "harness/plan/plan.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace hausbench {

// Maps each job to a shard. When the experiment changes, jobs that have not changed keep their shard.
struct Shards {
    int of = 1;
    // Shard number of each job, from 1. The key is a hash of the identities of the job's cases.
    std::map<std::string, int> shards;

    // Returns the shard number of each job of the plan. Throws InputError if a job has no shard, because the experiment
    // has changed since the split was made.
    std::vector<int> of_jobs(const Plan& plan) const;
};

// Distributes the jobs of a plan over `of` shards. Jobs in `earlier` keep their shards, because tasks in the queue of a
// cluster may rely on them; other jobs go to the shards with the least work. If `earlier` has another number of shards,
// all jobs are distributed anew.
Shards split(const Plan& plan, const Estimates& estimates, int of, const Shards& earlier = {});

// Reads a split. Throws InputError if the file is not a split.
Shards read_split(const std::filesystem::path& file);
void write_split(const std::filesystem::path& file, const Shards& split);

}  // namespace hausbench
