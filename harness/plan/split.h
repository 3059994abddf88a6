// Deals the jobs of a plan out to shards: so that each takes about as long, by the estimates.
#pragma once

#include "harness/plan/estimate.h"
#include "harness/plan/plan.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace hausbench {

// The part, from 0 on, of each of these times: the longest first, each to the part that has the least so far. Deterministic; the
// longest part takes at most 4/3 of the least possible (Graham 1969).
std::vector<int> balanced(const std::vector<double>& seconds, int parts);

// Which shard has which job. It outlives changes of the experiment: a job that is still the same stays where it is.
struct Split {
    int of = 1;
    // Shard, from 1 on, by the job's key: a hash of the identities of its cases.
    std::map<std::string, int> shards;

    // The shard of each job of the plan. Throws InputError where one is not in the split: the experiment has changed since.
    std::vector<int> of_jobs(const Plan& plan) const;
};

// Deals out what `earlier` does not know, beside what it knows, which stays: tasks that wait may still need it. Of another number of
// shards, everything.
Split split(const Plan& plan, const Estimates& estimates, int of, const Split& earlier = {});

// Throws InputError for a file that is none of these.
Split read_split(const std::filesystem::path& file);
void write_split(const std::filesystem::path& file, const Split& split);

}  // namespace hausbench
