// `hausbench run S.toml --engine slurm` and `hausbench status S.toml` run an experiment as jobs of a cluster.
//
// The jobs of the plan are distributed over shards (split.h). Slurm runs an array with one task per shard, each of
// them `hausbench run --shard i/n` with its own journal, and then `hausbench run --collect`, which makes one result
// of all journals. If a task is killed, requeued or lost with its node, only the cases it was running are lost;
// submitting again runs only the cases that no journal has. The program and the folder of results must be the same on
// all nodes. Each profile has its own split, array and journals.
#pragma once

#include "harness/commands/experiment_arguments.h"

#include <optional>
#include <string>
#include <vector>

namespace hausbench {

struct ClusterArguments {
    int shards = 0;                   // 0: as before; the first time one per job, but at most 16
    std::vector<std::string> sbatch;  // more options for sbatch
    bool any_build = false;           // passed on to the tasks and the collection
    bool wait = false;                // waits until the result is there
};

// Submits the shards that have open cases and are not in the queue, and prints their number. Returns the exit code;
// with `wait`, the exit code of `run --collect`. Returns nothing if every case is finished, so that only collecting
// is left. Throws InputError if Slurm's commands do not run or fail.
std::optional<int> submit(const ExperimentArguments& arguments, const Plan& plan, const ClusterArguments& cluster);

// Returns a table with the finished cases of each shard and its state in the queue.
std::string cluster_status(const ExperimentArguments& arguments, const Plan& plan);

// Returns the suffix after the stem in the names of a shard's journal and result. With `of_cluster` it includes the
// profile, because other profiles may run at the same time.
std::string shard_suffix(const Experiment& experiment, const Shard& shard, bool of_cluster);

// Returns the names of the journals of all shards, without extension: the shards of the cluster's split if there is
// one, otherwise those made with --shard.
std::vector<std::string> shard_names(const std::filesystem::path& results, const Experiment& experiment);

}  // namespace hausbench
