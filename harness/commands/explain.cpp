// `hausbench explain`: what a run would prepare, run and leave out, why, and about how long it would take.
#include "algorithms/error.h"
#include "harness/commands/experiment_arguments.h"
#include "harness/commands/explain_plan.h"
#include "harness/run/earlier.h"

#include <fmt/format.h>

namespace hausbench {

void add_explain(CLI::App& app, int&) {
    static ExperimentArguments arguments;
    auto* verb = app.add_subcommand(
        "explain", "show what a run would prepare, run and leave out, with reasons and an estimate of the time");
    take_experiment(verb, arguments);
    verb->add_option("--results", arguments.results,
                     "folder with earlier results, for the estimate of the time (default: results of the project)");
    take_plugins(verb);
    verb->callback([] {
        const Plan plan = plan_of(arguments, false);
        const std::filesystem::path results = results_of(arguments);
        print(explain(plan, results));
        try {
            refuse_to_replace(results / (plan.experiment.stem + ".h5"), plan.experiment, false);
        } catch (const InputError& error) {
            say({fmt::format("`run` would stop here: {}", error.what())});
        }
    });
}

}  // namespace hausbench
