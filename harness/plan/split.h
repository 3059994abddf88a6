// Distributes the jobs of a plan over shards, so that all shards take about equally long according to the estimates.
#pragma once

#include "harness/plan/estimate.h"
#include "harness/plan/plan.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace hausbench {

// Distributes jobs that take these times over `parts` parts, and returns the part of each job, from 0. The longest job
// comes first, and each goes to the part with the least total so far. Deterministic; the longest part takes at most 4/3
// of the least possible time (Graham 1969).
std::vector<int> balanced(const std::vector<double>& seconds, int parts);

// The shard of each job. A split stays valid when the experiment changes: jobs that have not changed keep their shard.
struct Split {
    int of = 1;
    // Shard (from 1) by the job's key, a hash of the identities of its cases.
    std::map<std::string, int> shards;

    // Returns the shard of each job of the plan. Throws InputError if a job is not in the split, because the
    // experiment has changed since.
    std::vector<int> of_jobs(const Plan& plan) const;
};

// Returns `earlier` with the jobs that are missing from it. Jobs in `earlier` keep their shards, because tasks that
// still wait in the queue of a cluster may need them; the other jobs fill up the shards with the least work. If
// `earlier` does not have `of` shards, distributes all jobs anew.
Split split(const Plan& plan, const Estimates& estimates, int of, const Split& earlier = {});

// Reads a split. Throws InputError if the file is not a split.
Split read_split(const std::filesystem::path& file);
void write_split(const std::filesystem::path& file, const Split& split);

}  // namespace hausbench
