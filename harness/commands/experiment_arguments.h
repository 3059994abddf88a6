// Command-line options shared by `run`, `explain` and `status`.
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

// Adds the argument for the experiment file, and the options that choose its profile, solvers and scenes.
inline void take_experiment(CLI::App* verb, ExperimentArguments& arguments) {
    verb->add_option("experiment", arguments.file, "an experiment file (.toml), or the name of one of the project")
        ->type_name("EXPERIMENT")
        ->required();
    verb->add_option("--profile", arguments.profile, "quick (minutes), paper (full sizes) or one of the file's own")
        ->type_name("PROFILE")
        ->capture_default_str();
    verb->add_option("--solver", arguments.choice.solvers, "only the solver with this label; may be repeated")
        ->type_name("LABEL")
        ->allow_extra_args(false);
    verb->add_option("--with", arguments.with,
                     "another solver alone, on the same scenes; its experiment is called NAME_SOLVER")
        ->type_name("SOLVER")
        ->excludes("--solver")
        ->check([](const std::string& name) { return name.empty() ? "name a solver" : ""; });
    verb->add_option("--scene", arguments.choice.scenes, "only this scene; may be repeated")
        ->type_name("SCENE")
        ->allow_extra_args(false);
}

// Reads the experiment and makes its plan. Unless `quiet`, shows progress while models are prepared.
Plan plan_of(const ExperimentArguments& arguments, bool quiet);
// Returns a function that loads the shape of a model recorded in a result. It searches the models of the project and of
// the experiment, and throws InputError if the model is missing or has changed.
ShapeOf recorded_shapes(const Experiment& experiment);
// Returns the folder given with --results, or the default, results_folder() of paths.h.
std::filesystem::path results_of(const ExperimentArguments& arguments);

}  // namespace hausbench
