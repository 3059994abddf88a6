#include "commands/experiment_arguments.h"

#include "paths.h"
#include "plan/own_models.h"
#include "run/progress.h"

namespace hausbench {

Plan plan_of(const ExperimentArguments& arguments, bool quiet) {
    const Experiment experiment = read_experiment(arguments.file, arguments.profile);
    static Catalogue models = catalogue();  // the plan points into it
    add_own_models(models, experiment);
    Progress progress(quiet);
    return make_plan(experiment, models, arguments.choice,
                     [&](const std::string& name, std::size_t before, std::size_t of) {
                         if (before == 0) progress.total(of);
                         if (before > 0) progress.done(1);
                         progress.doing("model " + name);
                     });
}

std::filesystem::path results_of(const ExperimentArguments& arguments) {
    return arguments.results.empty() ? results_folder() : arguments.results;
}

}  // namespace hausbench
