// Runs an experiment as jobs of a Slurm cluster (`hausbench run S.toml --engine slurm`) and shows its progress
// (`hausbench status S.toml`).
//
// The jobs of the plan are distributed over shards (split.h). Slurm runs an array with one task per shard; each task
// calls `hausbench run --shard i/n` and writes its own journal. Then Slurm runs the collection, `hausbench run
// --collect`, which makes one result from all journals. If a task is killed, requeued or lost with its node, only the
// cases it was running are lost; submitting again runs only the cases that no journal has. All nodes must see the same
// program and the same folder of results under the same paths. Each profile has its own split, array and journals.
#pragma once

#include "harness/commands/experiment_arguments.h"

#include <optional>
#include <string>
#include <vector>

namespace hausbench {

struct ClusterArguments {
    int shards = 0;                   // 0: as in the last submission; at first one per job, but at most 16
    std::vector<std::string> sbatch;  // more options for sbatch
    bool any_build = false;           // --any-build, passed on to the tasks and the collection
    bool wait = false;                // waits until the result is written
};

// Submits the shards that have unfinished cases and are not in Slurm's queue yet, then the job that collects their
// results. Prints the number of shards. Returns the exit code: 0, or with `wait` the exit code of the collecting job.
// Returns nothing if every case is finished and the queue is empty; the caller must then collect the results. Throws
// InputError if a Slurm command fails.
std::optional<int> submit(const ExperimentArguments& arguments, const Plan& plan, const ClusterArguments& cluster);

// Returns a table with the number of finished cases of each shard and its state in Slurm's queue. Without shards, the
// table has only the total.
std::string cluster_status(const ExperimentArguments& arguments, const Plan& plan);

// Returns the ending of a shard's file names, such as ".shard-2-of-16". With `of_cluster`, it starts with the profile
// (".paper.shard-2-of-16"), because profiles may run at the same time.
std::string shard_suffix(const Experiment& experiment, const Shard& shard, bool of_cluster);

// Returns the file names of the journals of all shards, without extension: the shards of the cluster if there is a
// split for it, otherwise those made with --shard.
std::vector<std::string> shard_names(const std::filesystem::path& results, const Experiment& experiment);

}  // namespace hausbench
