// The options that `run` and `explain` share.
#pragma once

#include "harness/commands/verb.h"
#include "harness/plan/plan.h"

#include <filesystem>
#include <string>

namespace hausbench {

struct ExperimentArguments {
    std::filesystem::path file, results;
    std::string profile = "quick", with;
    Choice choice;
};

// Adds the options for the file and its profile, solvers and scenes.
inline void take_experiment(CLI::App* verb, ExperimentArguments& arguments) {
    verb->add_option("experiment", arguments.file,
                     "experiment file (.toml), or the name of one of the project, such as zhang2017_table3")
        ->required();
    verb->add_option("--profile", arguments.profile, "quick: minutes; paper: the papers' full sizes")
        ->capture_default_str();
    verb->add_option("--solver", arguments.choice.solvers,
                     "only this solver (its label in the experiment); may be repeated")
        ->allow_extra_args(false);
    verb->add_option(
            "--with", arguments.with,
            "the scenes of the experiment for this solver alone, with its defaults, whether or not the experiment "
            "names it: an experiment of its own, NAME_SOLVER")
        ->excludes("--solver")
        ->check([](const std::string& name) { return name.empty() ? "name a solver" : ""; });
    verb->add_option("--scene", arguments.choice.scenes, "only this scene; may be repeated")->allow_extra_args(false);
}

Plan plan_of(const ExperimentArguments& arguments, bool quiet);
// Returns a function that reads the shapes that a result recorded, from the models of the project and of the
// experiment. The catalogue is made at its first call.
ShapeOf recorded_shapes(const Experiment& experiment);
// Returns the folder of results: the given one, otherwise results_folder() of paths.h.
std::filesystem::path results_of(const ExperimentArguments& arguments);

}  // namespace hausbench
