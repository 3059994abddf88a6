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

// Removes the jobs of all other shards from the plan. `split_file` gives the shard of each job; if it is empty, splits
// the plan here.
void take_shard(Plan& plan, const Shard& shard, const std::filesystem::path& split_file) {
    const Shards parts = split_file.empty() ? split(plan, Estimates({}), shard.of) : read_split(split_file);
    if (parts.of != shard.of)
        throw InputError(
            fmt::format("{}: has {} shards, not {}: submit again", split_file.string(), parts.of, shard.of));
    take_shard(plan, shard, parts.of_jobs(plan));
}

// Throws InputError for options that cannot be combined with --engine slurm.
void refuse_with_slurm(const RunArguments& arguments) {
    const std::pair<bool, const char*> others[] = {
        {arguments.fresh, "--fresh (remove the journals of its shards instead)"},
        {arguments.collect, "--collect"},
        {!arguments.again.empty(), "--again"},
        {!arguments.with.empty(), "--with (copy the experiment and name the solver in it)"},
        {arguments.jobs > 1, "--jobs (each task runs one case at a time)"},
        {arguments.shard != "1/1", "--shard"},
        {arguments.choice.leave_nothing_out, "--leave-nothing-out"},
        {arguments.strict, "--strict (give it to `hausbench run --collect` afterwards)"},
        {arguments.no_reference, "--no-reference (write `reference = false` into the experiment)"}};
    for (const auto& [given, name] : others) {
        if (given)
            throw InputError(fmt::format("--engine slurm cannot be combined with {}: leave one of them out", name));
    }
}

// Returns whether a case failed, crashed or ran out of memory while it ran. Cases that were not started do not count.
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
            throw InputError("--collect makes one result of whole shards: leave out --shard and --leave-nothing-out");
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
    verb->add_option("--engine", arguments.engine,
                     "where it runs; slurm submits shards, and only those that are missing")
        ->type_name("here|slurm")
        ->check(CLI::IsMember({"here", "slurm"}))
        ->capture_default_str();
    verb->add_option("--shards", arguments.slurm.shards,
                     "with slurm: number of shards (default: as before, or at most 16)")
        ->type_name("N")
        ->check(CLI::PositiveNumber);
    verb->add_option("--sbatch", arguments.slurm.sbatch,
                     "with slurm: option for sbatch, such as --sbatch=--partition=long; may be repeated")
        ->type_name("OPTION")
        ->allow_extra_args(false);
    verb->add_flag("--wait", arguments.slurm.wait, "with slurm: waits for the result");
    verb->add_flag("--cluster", arguments.cluster, "keeps rows of other machines; marks times as not comparable");
    verb->add_flag("--collect", arguments.collect, "runs nothing; joins what shards have finished");
    verb->add_option("--split", arguments.split, "which shard has which jobs, as --engine slurm wrote it")->group("");
}

}  // namespace

void add_run(CLI::App& app, int& code) {
    static RunArguments arguments;
    auto* verb = add_verb(app, "run", "runs an experiment and writes its result; resumes an interrupted run",
                          "hausbench run zhang2017_table3 --solver scan",
                          "Exit code 1: a row is unsound, and the experiment does not expect that.");
    take_experiment(verb, arguments);
    take_results_folder(verb, arguments.results,
                        "folder of the result file (default: results, in the checkout of the experiment or here)");
    verb->add_option("--shard", arguments.shard, "only part I of N; `merge` joins the parts")
        ->type_name("I/N")
        ->capture_default_str();
    verb->add_option("--jobs", arguments.jobs,
                     "cases at a time, each on its own core, as memory allows; marks times as not comparable")
        ->type_name("N")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    verb->add_option("--again", arguments.again,
                     "runs finished cases again, chosen as in `show --where`; may be repeated")
        ->type_name("COLUMN=VALUE")
        ->allow_extra_args(false);
    verb->add_flag("--strict", arguments.strict, "exit code 1 also if a case failed, crashed or ran out of memory");
    verb->add_flag("--fresh", arguments.fresh,
                   "runs finished cases again; also replaces the result of another experiment of this name");
    verb->add_flag("--any-build", arguments.any_build, "keeps rows of another build or machine");
    verb->add_flag("--leave-nothing-out", arguments.choice.leave_nothing_out,
                   "runs every tolerance and builds every structure, into NAME.everything.h5; no answer may change");
    verb->add_flag("--no-reference", arguments.no_reference, "computes no certified answers to compare with");
    verb->add_flag("--quiet", arguments.quiet, "shows no progress");
    take_cluster_options(verb, arguments);
    take_plugins(verb);
    verb->callback([&code] { code = run(arguments); });
}

}  // namespace hausbench
