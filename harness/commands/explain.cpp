// `hausbench explain`: shows what would be prepared, run and left out, why, and about how long a run would take.
#include "algorithms/contract.h"
#include "algorithms/error.h"
#include "algorithms/printable.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "datasets/shape_file.h"
#include "harness/commands/experiment_arguments.h"
#include "harness/commands/row_texts.h"
#include "harness/plan/estimate.h"
#include "harness/plan/references.h"
#include "harness/result/provenance.h"
#include "harness/run/earlier.h"
#include "process/memory.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <utility>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

std::string clock_text(double seconds) {
    return seconds < 10    ? fmt::format("{:.1f} s", seconds)
           : seconds < 120 ? fmt::format("{:.0f} s", seconds)
                           : fmt::format("{:.1f} min", seconds / 60);
}

std::size_t shapes_of(const Job& job) {
    std::set<fs::path> files;
    for (const Job::Pair& pair : job.pairs) files.insert({pair.source_file, pair.target_file});
    return files.size();
}

// Keeps the shape that was read last, because most jobs have the same shapes as the job before.
class LastShape {
public:
    const SharedShape& of(const fs::path& file) {
        if (file_ != file) shape_.emplace(read_shape(file).shape);
        file_ = file;
        return *shape_;
    }

private:
    fs::path file_;
    std::optional<SharedShape> shape_;
};

struct LastScene {
    LastShape source, target;
};

// Adds a line for each structure that the solver may need: whether it is prepared or left out for this scene, or for
// the first pair of a matrix.
void describe_needs(const Plan& plan, const Job& job, LastScene& last, std::string& text) {
    const Case& first = plan.cases[job.cases.front()];
    const SolverEntry& entry = find_solver(first.solver);
    if (entry.info.may_need.empty() && !is_of_plugin(first.solver)) return;
    const Job::Pair& pair = job.pairs.front();
    const Scene scene{last.source.of(pair.source_file), last.target.of(pair.target_file)};
    const Options options(first.solver, entry.info.parameters, first.options);
    const Needs needs = checked_needs(entry, *make_solver(entry, options), scene, pair.queries);
    for (const Need& need : entry.info.may_need) {
        const bool wanted = std::find(needs.begin(), needs.end(), need) != needs.end();
        text += fmt::format("      {} {}\n", wanted ? "prepares" : "leaves out", to_string(need));
    }
}

// Returns the solver and its parameters as text, with every seed replaced by "seed=...".
std::string without_seed(const Case& spec) {
    static const std::regex seed("seed=[^,)]*");
    return std::regex_replace(shown(spec), seed, "seed=...");
}

// Groups jobs that have the same solver and scene and differ only in their seeds.
std::vector<std::vector<const Job*>> alike(const Plan& plan) {
    std::vector<std::vector<const Job*>> groups;
    std::map<std::pair<std::string, std::size_t>, std::size_t> number;
    for (const Job& job : plan.jobs) {
        const Case& first = plan.cases[job.cases.front()];
        const std::string name = without_seed(first) + first.statistic;
        const auto at = number.find({name, job.scene});
        if (at != number.end() && name != shown(first) + first.statistic) {
            groups[at->second].push_back(&job);
            continue;
        }
        number[{name, job.scene}] = groups.size();
        groups.push_back({&job});
    }
    return groups;
}

// Appends lines about these jobs to `text`. Returns their estimated total time and the largest estimated memory of a
// job.
JobEstimate describe_jobs(const Plan& plan, const std::vector<const Job*>& jobs, const Estimates& estimates,
                          LastScene& last, std::string& text) {
    const Experiment& e = plan.experiment;
    const Job& job = *jobs.front();
    const Case& first = plan.cases[job.cases.front()];
    const std::string label = printable(jobs.size() == 1 ? job.label
                                                         : fmt::format("{} on {}, {} seeds", without_seed(first),
                                                                       e.scenes[job.scene].name, jobs.size()));
    JobEstimate all;
    std::size_t cases = 0;
    for (const Job* seeded_job : jobs) {
        const JobEstimate estimate = estimates.of(plan, *seeded_job);
        all.seconds += estimate.seconds;
        all.timed_cases += estimate.timed_cases;
        all.bytes = std::max(all.bytes, estimate.bytes);
        cases += seeded_job->cases.size();
        if (const std::string reason = does_not_fit(plan, *seeded_job, this_machine().memory_bytes); !reason.empty())
            text += fmt::format("  {}: {}\n", printable(seeded_job->label), reason);
    }
    text += fmt::format("  {:<44} {:>4} {}, about {}{}, {} MB\n", label, cases, cases == 1 ? "case" : "cases",
                        clock_text(all.seconds), all.timed_cases == cases ? "" : " (a guess)", all.bytes >> 20);
    describe_needs(plan, job, last, text);
    std::set<int> poses;
    for (std::size_t row : job.cases) poses.insert(plan.cases[row].pose_index);
    if (job.pairs.front().queries.target_copied)
        text += "      the target moves, so structures are built again for each pose\n";
    else if (job.exponent && job.pairs.size() > 1)
        text += fmt::format("      each of {} shapes is loaded and prepared once for all {} pairs\n", shapes_of(job),
                            job.pairs.size());
    else if (poses.size() > 1)
        text += fmt::format("      structures are built once and used for all {} poses\n", poses.size());
    if (e.scenes[job.scene].search)
        text += "      a search: the cutoff of each target is the least upper bound of those before it\n";
    return all;
}

// Returns the text that `explain` prints, with estimates based on the result files in `results`.
std::string explain(const Plan& plan, const fs::path& results) {
    const Estimates estimates(results);
    const Experiment& e = plan.experiment;
    std::size_t run = 0, timed = 0;
    for (const Job& job : plan.jobs) run += job.cases.size();
    std::string text = fmt::format(
        "{} ({}, profile {}): {} asked for, {} to run in {}, {}, {} each\n", printable(e.stem), printable(e.title),
        e.profile, counted(plan.cases.size(), "case"), run, counted(plan.jobs.size() * std::size_t(e.rounds), "worker"),
        counted(std::size_t(e.rounds), "round"), counted(std::size_t(e.repeats), "timed repeat"));
    text += "MODELS\n";
    for (const ModelRow& model : plan.models) {
        text += fmt::format("  {:<28} {:>9} {}, {} {:.6g}\n", printable(model.info->name), model.resolved.elements,
                            model.resolved.kind == ShapeKind::points    ? "points"
                            : model.resolved.kind == ShapeKind::surface ? "surface"
                                                                        : "triangles",
                            e.of == "longest" ? "longest side" : "diagonal",
                            e.of == "longest" ? model.resolved.longest_side : model.resolved.diagonal);
    }
    text += "RUN\n";
    double total = 0;
    std::int64_t most = 0;
    LastScene last;
    for (const auto& jobs : alike(plan)) {
        const JobEstimate all = describe_jobs(plan, jobs, estimates, last, text);
        total += all.seconds;
        timed += all.timed_cases;
        most = std::max(most, all.bytes);
    }
    if (e.trace) {
        std::set<std::string> silent;
        for (const Job& job : plan.jobs) {
            const Case& first = plan.cases[job.cases.front()];
            if (!find_solver(first.solver).info.can(Ability::traces)) silent.insert(first.label);
        }
        if (!silent.empty())
            text += fmt::format("TRACE\n  nothing is traced of {}, which report no bounds on the way\n",
                                printable(fmt::format("{}", fmt::join(silent, ", "))));
    }
    if (plan.references) {
        double seconds = 0;
        for (const Job& job : plan.references->jobs) seconds += estimates.of(*plan.references, job).seconds;
        text += fmt::format("REFERENCE\n  {}, certified and not timed, at most {} s each: about {}; {}\n",
                            counted(plan.references->cases.size(), "answer"), e.reference_seconds, clock_text(seconds),
                            rows_are_compared);
        total += seconds;
    }
    text += "LEFT OUT, beside the structures above\n";
    const std::size_t head = text.size();
    for (const LedgerEntry& entry : plan.ledger) {
        if (entry.kind == "prepared_again") continue;  // shown above
        text += fmt::format("  {:<44} {} ({}): {}\n", printable(entry.subject), printable(entry.what), entry.count,
                            printable(entry.reason));
    }
    if (text.size() == head) text += "  nothing\n";
    text += fmt::format("TIME  about {}; {} of {} cases have times of an earlier run on this machine\n",
                        clock_text(total), timed, run);
    text +=
        fmt::format("MEMORY  about {} MB for the largest worker; {} MB are free\n", most >> 20, spare_bytes() >> 20);
    return text;
}

}  // namespace

void add_explain(CLI::App& app, int&) {
    static ExperimentArguments arguments;
    auto* verb = add_verb(app, "explain", "shows what a run would do and leave out, and how long it would take",
                          "hausbench explain guthe2005_table1");
    take_experiment(verb, arguments);
    take_results_folder(verb, arguments.results, "folder of earlier results, which tell the time (default: results)");
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
