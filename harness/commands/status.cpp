// `hausbench status`: shows how many cases of an experiment are finished, here or on a cluster.
#include "harness/commands/cluster.h"

namespace hausbench {

void add_status(CLI::App& app, int&) {
    static ExperimentArguments arguments;
    auto* verb = app.add_subcommand(
        "status", "show how many cases of an experiment are finished; of one that was given to a cluster, by shard");
    take_experiment(verb, arguments);
    verb->add_option("--results", arguments.results, "folder with its journals (default: results of the project)");
    take_plugins(verb);
    verb->callback([] { print(cluster_status(arguments, plan_of(arguments, true))); });
}

}  // namespace hausbench
