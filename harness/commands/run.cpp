// `hausbench run`: runs an experiment and writes its results.
#include "harness/run/runner.h"

#include "algorithms/error.h"
#include "harness/commands/cluster.h"
#include "harness/commands/experiment_arguments.h"
#include "harness/commands/row_choice.h"
#include "harness/commands/summary.h"
#include "harness/plan/estimate.h"
#include "harness/plan/split.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace hausbench {

namespace {

struct RunArguments : ExperimentArguments {
    std::string shard = "1/1", engine = "here";
    std::filesystem::path split;
    int jobs = 1;
    std::vector<std::string> again;
    bool fresh = false, any_build = false, quiet = false, cluster = false, collect = false, no_reference = false;
    bool strict = false;
    ClusterArguments slurm;
};

void take_shard(Plan& plan, const Shard& shard, const std::filesystem::path& split_file) {
    const Split parts = split_file.empty() ? split(plan, Estimates({}), shard.of) : read_split(split_file);
    if (parts.of != shard.of)
        throw InputError(
            fmt::format("{}: has {} shards, not {}: submit again", split_file.string(), parts.of, shard.of));
    take_shard(plan, shard, parts.of_jobs(plan));
}

// Refuses options that --engine slurm cannot pass on to its tasks.
void refuse_with_slurm(const RunArguments& arguments) {
    const std::pair<bool, const char*> others[] = {
        {arguments.fresh, "--fresh (remove the journals of its shards instead)"},
        {arguments.collect, "--collect"},
        {!arguments.again.empty(), "--again"},
        {!arguments.with.empty(), "--with (copy the experiment and name the solver in it)"},
        {arguments.jobs > 1, "--jobs (each task runs one case at a time)"},
        {arguments.shard != "1/1", "--shard"},
        {arguments.choice.leave_nothing_out, "--leave-nothing-out"},
        {arguments.choice.planted_slowdown > 0, "--planted-slowdown"}};
    for (const auto& [given, name] : others) {
        if (given) throw InputError(fmt::format("--engine slurm does not go with {}: leave one of them out", name));
    }
}

// Returns whether a case that was run failed. Cases that were left out have their reasons.
bool any_failed(const std::vector<Row>& rows) {
    return std::any_of(rows.begin(), rows.end(), [](const Row& row) {
        const RowStatus status = row.outcome.status;
        return status == RowStatus::failed || status == RowStatus::signal ||
               (status == RowStatus::out_of_memory && !row.outcome.reason.starts_with(not_started));
    });
}

int run(RunArguments& arguments) {
    if (arguments.engine == "slurm") refuse_with_slurm(arguments);
    Plan plan = plan_of(arguments, arguments.quiet);
    if (arguments.no_reference) {
        plan.experiment.reference = false;
        plan.references.reset();
    }
    if (arguments.engine == "slurm") {
        arguments.slurm.any_build = arguments.any_build;
        if (const auto code = submit(arguments, plan, arguments.slurm)) return *code;
        arguments.collect = true;
    }
    if (arguments.collect && !arguments.again.empty()) throw InputError("--collect runs nothing: leave out --again");
    if (arguments.collect) arguments.cluster = true;
    const Shard shard = parse_shard(arguments.shard);
    if (!shard.whole() || !arguments.split.empty()) take_shard(plan, shard, arguments.split);
    std::string suffix = arguments.choice.leave_nothing_out ? ".everything" : "";
    if (arguments.choice.planted_slowdown > 0) suffix += ".planted";  // distorted times, kept apart from other results
    if (!shard.whole() || !arguments.split.empty())
        suffix += shard_suffix(plan.experiment, shard, !arguments.split.empty());
    const std::filesystem::path results = results_of(arguments);
    RunOptions options{.results = results,
                       .fresh = arguments.fresh,
                       .any_build = arguments.any_build,
                       .quiet = arguments.quiet,
                       .jobs = arguments.jobs,
                       .cluster = arguments.cluster,
                       .suffix = suffix,
                       .again = arguments.again.empty() ? nullptr : row_test(arguments.again, "--again"),
                       .shapes_of = recorded_shapes};
    if (arguments.collect) {
        if (!suffix.empty())
            throw InputError(
                "--collect makes one result of whole shards: leave out --shard, --leave-nothing-out and "
                "--planted-slowdown");
        options.collect = shard_names(results, plan.experiment);
        if (options.collect.empty())
            throw InputError(
                fmt::format("{}: has no journal of a shard of {}: {} first", results.string(), plan.experiment.stem,
                            arguments.with.empty() ? "submit it with --engine slurm" : "run its shards, with --shard"));
    }
    const RunSummary summary = run_plan(plan, options);
    print(show_summary(summary.result, paper_of_output()));
    print(describe_references(summary.result));
    say(describe_wrong_exact(summary.result));
    say(describe_tried(summary.result));
    const auto expected = summary.unsound_expected;
    print(fmt::format("{}: {}{}{}\n", summary.file.string(), count_statuses(summary.result.rows),
                      expected ? fmt::format(" ({} of the unsound as expected)", expected) : "",
                      summary.kept ? fmt::format("; {} rows of earlier runs are kept", summary.kept) : ""));
    for (const std::string& row : summary.unsound) say({"unsound: " + row});
    if (summary.interrupted) {
        fmt::print(stderr, "interrupted: finished cases are saved; the same command resumes here\n");
        return 130;
    }
    if (arguments.collect && summary.open > 0) {
        say({fmt::format("{} of {} cases are missing: submit again", summary.open, summary.result.rows.size())});
        return 1;
    }
    return summary.unsound.empty() && !(arguments.strict && any_failed(summary.result.rows)) ? 0 : 1;
}

void take_cluster_options(CLI::App* verb, RunArguments& arguments) {
    verb->add_option(
            "--engine", arguments.engine,
            "here, or slurm: give it to a cluster, as an array with a task for each shard and a job that collects "
            "their results; again: only what is missing")
        ->check(CLI::IsMember({"here", "slurm"}))
        ->capture_default_str();
    verb->add_option("--shards", arguments.slurm.shards,
                     "of --engine slurm: how many parts (default: as before, or at most 16)")
        ->check(CLI::PositiveNumber);
    verb->add_option(
            "--sbatch", arguments.slurm.sbatch,
            "of --engine slurm: one more option for sbatch, such as --sbatch=--partition=long; may be repeated")
        ->allow_extra_args(false);
    verb->add_flag("--wait", arguments.slurm.wait, "of --engine slurm: until the result is there");
    verb->add_flag(
        "--cluster", arguments.cluster,
        "the machine is one of several that others use too: rows of the others stay, and rows say that their "
        "times compare with none");
    verb->add_flag("--collect", arguments.collect, "run nothing: make one result of what shards have finished");
    verb->add_option("--split", arguments.split, "which shard has which jobs, as --engine slurm wrote it")->group("");
}

}  // namespace

void add_run(CLI::App& app, int& code) {
    static RunArguments arguments;
    auto* verb = app.add_subcommand("run",
                                    "run an experiment and write its results; resumes an interrupted run; exit code 1 "
                                    "if a row is unsound that the experiment does not expect to be");
    take_experiment(verb, arguments);
    verb->add_option(
        "--results", arguments.results,
        "folder for the result file (default: results of the checkout that has the experiment, else of the current "
        "folder)");
    verb->add_option("--shard", arguments.shard, "run only part i of n, written i/n; join the parts with `merge`")
        ->capture_default_str();
    verb->add_option("--jobs", arguments.jobs,
                     "run so many cases at a time, each on a core of its own, as memory allows; for answers, not for "
                     "times: rows say that theirs compare with none")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    verb->add_option("--again", arguments.again,
                     "run finished cases again that are so: COLUMN=VALUE as in `show --where`, such as status=signal; "
                     "may be repeated")
        ->allow_extra_args(false);
    verb->add_flag("--strict", arguments.strict, "exit code 1 also if a case failed, crashed or ran out of memory");
    verb->add_flag("--fresh", arguments.fresh,
                   "run every requested case again, even if it is finished; also replaces the result of another "
                   "experiment of the same name");
    verb->add_flag("--any-build", arguments.any_build,
                   "keep rows that were measured by another build or on another machine");
    verb->add_flag(
        "--leave-nothing-out", arguments.choice.leave_nothing_out,
        "run every tolerance and build every structure, into STEM.everything.h5: to check that no answer changes");
    verb->add_option("--planted-slowdown", arguments.choice.planted_slowdown,
                     "make each repeat slower by this share, into STEM.planted.h5: `track` tests itself with it")
        ->check(CLI::Range(0.0, 10.0))
        ->group("");
    verb->add_flag("--no-reference", arguments.no_reference, "as `reference = false` in the experiment");
    verb->add_flag("--quiet", arguments.quiet, "show no progress");
    take_cluster_options(verb, arguments);
    take_plugins(verb);
    verb->callback([&code] { code = run(arguments); });
}

}  // namespace hausbench
