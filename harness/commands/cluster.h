// Runs an experiment as jobs of a Slurm cluster (`hausbench run S.toml --engine slurm`) and shows how far it is
// (`hausbench status S.toml`).
//
// The jobs of the plan are distributed over shards (split.h). Slurm runs an array with one task per shard: each task
// is a `hausbench run --shard i/n` and writes its own journal. After all tasks, Slurm runs the collection, `hausbench
// run --collect`, which makes one result from all journals. If a task is killed, requeued or lost with its node, only
// the cases it was running are lost; submitting again runs only the cases that no journal has. All nodes must see the
// same program and the same folder of results under the same paths. Each profile has its own split, array and
// journals.
#pragma once

#include "harness/commands/experiment_arguments.h"

#include <optional>
#include <string>
#include <vector>

namespace hausbench {

struct ClusterArguments {
    int shards = 0;                   // 0: as many as the last time; the first time one per job, but at most 16
    std::vector<std::string> sbatch;  // more options for sbatch
    bool any_build = false;           // --any-build, passed on to the tasks and the collection
    bool wait = false;                // waits until the result is written
};

// Submits the shards that have unfinished cases and are not in Slurm's queue yet, then the collection, and prints the
// number of shards. Returns the exit code: 0, or with `wait` the exit code of `run --collect`. Returns nothing if
// every case is finished and nothing is in the queue; the caller then has to collect. Throws InputError if Slurm's
// commands do not run or fail.
std::optional<int> submit(const ExperimentArguments& arguments, const Plan& plan, const ClusterArguments& cluster);

// Returns a table with the number of finished cases of each shard and the shard's state in Slurm's queue; without a
// split, only the number for all cases.
std::string cluster_status(const ExperimentArguments& arguments, const Plan& plan);

// Returns the suffix that follows the stem in the names of a shard's journal and result, such as ".shard-2-of-16".
// With `of_cluster` it is ".paper.shard-2-of-16": it includes the profile, because other profiles may run at the same
// time.
std::string shard_suffix(const Experiment& experiment, const Shard& shard, bool of_cluster);

// Returns the names of the journals of all shards, without extension: the shards of the cluster's split if there is
// one, otherwise those made with --shard.
std::vector<std::string> shard_names(const std::filesystem::path& results, const Experiment& experiment);

}  // namespace hausbench
