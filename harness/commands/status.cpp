// `hausbench status`: shows how many cases of an experiment are finished, here or on a cluster.
#include "harness/commands/cluster.h"

namespace hausbench {

void add_status(CLI::App& app, int&) {
    static ExperimentArguments arguments;
    auto* verb = add_verb(app, "status", "shows how many cases of an experiment are finished, on a cluster by shard",
                          "hausbench status guthe2005_table1");
    take_experiment(verb, arguments);
    take_results_folder(verb, arguments.results, "folder of its result and journals (default: results)");
    take_plugins(verb);
    verb->callback([] { print(cluster_status(arguments, plan_of(arguments, true))); });
}

}  // namespace hausbench
