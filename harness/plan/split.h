// Distributes the jobs of a plan over shards so that all take about equally long, by the estimates.
#pragma once

#include "harness/plan/estimate.h"
#include "harness/plan/plan.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace hausbench {

// Returns the part (from 0) for each of these times. Assigns the longest first, each to the part with the least total
// so far. Deterministic; the longest part takes at most 4/3 of the least possible time (Graham 1969).
std::vector<int> balanced(const std::vector<double>& seconds, int parts);

// The shard of each job. It stays valid when the experiment changes: a job that is still the same stays in its shard.
struct Split {
    int of = 1;
    // Shard (from 1) by the job's key, a hash of the identities of its cases.
    std::map<std::string, int> shards;

    // Returns the shard of each job of the plan. Throws InputError if a job is not in the split, because the
    // experiment has changed since.
    std::vector<int> of_jobs(const Plan& plan) const;
};

// Distributes the jobs that are not in `earlier`, taking the load of the jobs in it into account. Those stay in their
// shards: waiting tasks may still need them. If `earlier` has another number of shards, distributes all jobs.
Split split(const Plan& plan, const Estimates& estimates, int of, const Split& earlier = {});

// Reads a split. Throws InputError if the file is not one.
Split read_split(const std::filesystem::path& file);
void write_split(const std::filesystem::path& file, const Split& split);

}  // namespace hausbench
