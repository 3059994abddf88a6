// `hausbench run S.toml --engine slurm` and `hausbench status S.toml`: an experiment as jobs of a cluster.
//
// The jobs of the plan are dealt out to shards (split.h). Slurm runs an array with one task a shard, each of them
// `hausbench run --shard i/n` with a journal of its own, and then `hausbench run --collect`, which makes one result of all journals.
// So a task that is killed, requeued or lost with its node costs the cases that it was at, and what is submitted
// again runs only what no journal has. Folder of results and program must be the same on all nodes. Each profile has a split, an array
// and journals of its own.
#pragma once

#include "harness/commands/experiment_arguments.h"

#include <optional>
#include <string>
#include <vector>

namespace hausbench {

struct ClusterArguments {
    int shards = 0;                   // 0: as before, or else one for each job, but at most 16
    std::vector<std::string> sbatch;  // more options for it
    bool any_build = false;           // that tasks and the collection keep rows of
    bool wait = false;                // until the result is there
};

// Submits the shards that have open cases and are not in the queue, and prints what it submitted. Returns the exit code: with `wait` that
// of `run --collect`. Nothing where every case is finished: what there is has only to be collected. Throws InputError where Slurm's
// commands do not run or refuse.
std::optional<int> submit(const ExperimentArguments& arguments, const Plan& plan, const ClusterArguments& cluster);

// How many cases each shard has finished, and what the queue says of it.
std::string cluster_status(const ExperimentArguments& arguments, const Plan& plan);

// What follows the stem in the names of a shard's journal and result; `of_cluster`: of its profile, which others may be at work beside.
std::string shard_suffix(const Experiment& experiment, const Shard& shard, bool of_cluster);

// The names of the journals of all shards, without their ending: those of the split that a cluster has, else those of --shard.
std::vector<std::string> shard_names(const std::filesystem::path& results, const Experiment& experiment);

}  // namespace hausbench
