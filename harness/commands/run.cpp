// `hausbench run`: runs an experiment and writes its results.
#include "run/runner.h"

#include "commands/experiment_arguments.h"
#include "commands/summary.h"

#include <fmt/format.h>

namespace hausbench {

namespace {

struct RunArguments : ExperimentArguments {
    std::string shard = "1/1";
    bool fresh = false, any_build = false, quiet = false;
};

int run(const RunArguments& arguments) {
    Plan plan = plan_of(arguments, arguments.quiet);
    const Shard shard = parse_shard(arguments.shard);
    take_shard(plan, shard);
    std::string suffix = arguments.choice.leave_nothing_out ? ".everything" : "";
    if (arguments.choice.planted_slowdown > 0) suffix += ".planted";  // no times of a solver: never among other results
    if (!shard.whole()) suffix += fmt::format(".shard-{}-of-{}", shard.number, shard.of);
    const RunSummary summary =
        run_plan(plan, {results_of(arguments), arguments.fresh, arguments.any_build, arguments.quiet, suffix});
    print(show_summary(summary.result, paper_of_output()));
    const auto expected = summary.unsound_expected;
    print(fmt::format("{}: {}{}{}\n", summary.file.string(), count_statuses(summary.result.rows),
                      expected ? fmt::format(" ({} of the unsound as expected)", expected) : "",
                      summary.kept ? fmt::format("; {} rows of earlier runs are kept", summary.kept) : ""));
    for (const std::string& row : summary.unsound) say({"unsound: " + row});
    if (summary.interrupted) {
        fmt::print(stderr, "interrupted: finished cases are saved; the same command resumes here\n");
        return 130;
    }
    return summary.unsound.empty() ? 0 : 1;
}

}  // namespace

void add_run(CLI::App& app, int& code) {
    static RunArguments arguments;
    auto* verb = app.add_subcommand("run",
                                    "run an experiment and write its results; resumes an interrupted run; exit code 1 "
                                    "if a row is unsound that the experiment does not expect to be");
    take_experiment(verb, arguments);
    verb->add_option("--results", arguments.results,
                     "folder for the result file (default: results of the project, or of the working directory)");
    verb->add_option("--shard", arguments.shard, "run only part i of n, written i/n; join the parts with `merge`")
        ->capture_default_str();
    verb->add_flag("--fresh", arguments.fresh, "start over: discard the finished cases of an earlier run");
    verb->add_flag("--any-build", arguments.any_build,
                   "keep rows that were measured by another build or on another machine");
    verb->add_flag(
        "--leave-nothing-out", arguments.choice.leave_nothing_out,
        "run every tolerance and build every structure, into STEM.everything.h5: to check that no answer changes");
    verb->add_option("--planted-slowdown", arguments.choice.planted_slowdown,
                     "make each repeat slower by this share, into STEM.planted.h5: `track` tests itself with it")
        ->check(CLI::Range(0.0, 10.0))
        ->group("");
    verb->add_flag("--quiet", arguments.quiet, "show no progress");
    take_plugins(verb);
    verb->callback([&code] { code = run(arguments); });
}

}  // namespace hausbench
