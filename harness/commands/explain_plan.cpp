#include "commands/explain_plan.h"

#include "contract.h"
#include "error.h"
#include "plan/lookup.h"
#include "registry.h"
#include "result/provenance.h"
#include "result/result_file.h"
#include "session.h"
#include "shape_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

constexpr double start_seconds = 0.02;         // of a worker, loading a middling shape included
constexpr double seconds_per_distance = 3e-9;  // point to point, cache misses not counted
constexpr double distances_per_point = 300, distances_per_triangle = 3000;  // of solvers that use trees, roughly

double expected_work(const Case& c) {
    const double a = double(c.source_elements), b = double(c.target_elements);
    if (c.solver == "naive") return a * b;
    for (const SolverEntry& entry : solvers()) {
        if (entry.info.name == c.solver)
            return (entry.info.target.mesh ? distances_per_triangle : distances_per_point) * (a + b);
    }
    return distances_per_point * (a + b);
}

struct Known {
    double prepare = 0, solve = 0;
    double work = 0;
    bool answered = false;
};

// What earlier runs on this machine took.
class Memory {
public:
    explicit Memory(const fs::path& results) {
        if (!fs::is_directory(results)) return;
        for (const auto& entry : fs::directory_iterator(results)) {
            if (entry.path().extension() != ".h5") continue;
            try {
                for (const Row& row : read_result(entry.path()).rows) learn(row);
            } catch (const InputError&) {  // a damaged file only costs us its times
            }
        }
    }

    Known of(const Case& asked) const {
        if (const auto at = cases_.find(asked.identity); at != cases_.end()) return at->second;
        const auto others = solvers_.find(asked.solver);
        const double work = expected_work(asked);
        if (others == solvers_.end()) return {0, work * seconds_per_distance, work, false};
        const Known& near = others->second.nearest(work);  // scaled to this case
        return {near.prepare * work / near.work, near.solve * work / near.work, work, false};
    }

private:
    void learn(const Row& row) {
        const Outcome& o = row.outcome;
        if (o.machine != this_machine().id || o.from_trace) return;
        const bool killed = o.status == RowStatus::timeout && !std::isfinite(o.solve_seconds);
        if (!killed && !std::isfinite(o.solve_seconds)) return;
        Known known{killed ? 0 : o.prepare_seconds, killed ? row.asked.limits.case_seconds : o.solve_seconds,
                    expected_work(row.asked), true};
        cases_[row.asked.identity] = known;
        if (known.work > 0) solvers_[row.asked.solver].add(known.work, known);
    }

    std::map<std::string, Known> cases_;
    std::map<std::string, NearestByWork<Known>> solvers_;
};

struct JobEstimate {
    double seconds = 0;
    std::size_t known = 0;  // cases that an earlier run answered
};

JobEstimate estimate(const Plan& plan, const Job& job, const Memory& memory) {
    const Experiment& e = plan.experiment;
    JobEstimate out;
    double prepare = 0;
    for (std::size_t row : job.cases) {
        const Case& asked = plan.cases[row];
        const Known known = memory.of(asked);
        prepare = std::max(prepare, known.prepare);
        out.known += known.answered;
        const double once = std::min(known.solve, asked.limits.case_seconds);
        const bool in_time = known.solve < asked.limits.case_seconds;
        const double repeats =
            in_time ? std::min(e.repeats * std::max(once, 5e-4), 2 * asked.limits.case_seconds + once) : 0;
        out.seconds += e.rounds * (once + repeats) + (e.trace && !plan.marks(row).empty() ? once : 0);
    }
    out.seconds += e.rounds * (start_seconds + prepare);
    return out;
}

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

// Which structures the solver asks for on this scene (of a matrix, on its first pair), and which it can do without.
void describe_needs(const Plan& plan, const Job& job, std::string& text) {
    const Case& first = plan.cases[job.cases.front()];
    const SolverEntry& entry = find_solver(first.solver);
    if (entry.info.may_need.empty() && !is_of_plugin(first.solver)) return;
    const Job::Pair& pair = job.pairs.front();
    const Scene scene{read_shape(pair.source_file).shape, read_shape(pair.target_file).shape};
    const Options options(first.solver, entry.info.parameters, first.options);
    const Needs needs = checked_needs(entry, *make_solver(entry, options), scene, pair.queries);
    for (const Need& need : entry.info.may_need) {
        const bool wanted = std::find(needs.begin(), needs.end(), need) != needs.end();
        text += fmt::format("      {} {}\n", wanted ? "prepares" : "leaves out", to_string(need));
    }
}

}  // namespace

std::string explain(const Plan& plan, const fs::path& results) {
    const Memory memory(results);
    const Experiment& e = plan.experiment;
    std::size_t run = 0, known = 0;
    for (const Job& job : plan.jobs) run += job.cases.size();
    std::string text = fmt::format(
        "{} ({}, profile {}): {} cases asked for, {} to run in {} workers, {} rounds, {} timed repeats each\n", e.stem,
        e.title, e.profile, plan.cases.size(), run, plan.jobs.size() * std::size_t(e.rounds), e.rounds, e.repeats);
    text += "MODELS\n";
    for (const ModelRow& model : plan.models) {
        text += fmt::format("  {:<28} {:>9} {}, {} {:.6g}\n", model.info->name, model.resolved.elements,
                            model.resolved.kind == ShapeKind::points    ? "points"
                            : model.resolved.kind == ShapeKind::surface ? "surface"
                                                                        : "triangles",
                            e.of == "longest" ? "longest side" : "diagonal",
                            e.of == "longest" ? model.resolved.longest_side : model.resolved.diagonal);
    }
    text += "RUN\n";
    double total = 0;
    for (const Job& job : plan.jobs) {
        const JobEstimate one = estimate(plan, job, memory);
        total += one.seconds;
        known += one.known;
        text += fmt::format("  {:<44} {:>4} cases, about {}{}\n", job.label, job.cases.size(), clock_text(one.seconds),
                            one.known == job.cases.size() ? "" : " (a guess)");
        describe_needs(plan, job, text);
        std::set<int> poses;
        for (std::size_t row : job.cases) poses.insert(plan.cases[row].pose_index);
        if (job.pairs.front().queries.target_copied)
            text += "      over a target that moves, what is prepared is built again for each pose\n";
        else if (job.exponent && job.pairs.size() > 1)
            text += fmt::format("      each of {} shapes is loaded and prepared once for all {} pairs\n",
                                shapes_of(job), job.pairs.size());
        else if (poses.size() > 1)
            text += fmt::format("      what is prepared is built once and used for all {} poses\n", poses.size());
        if (e.scenes[job.scene].search)
            text += "      a search: the cutoff of each target is the least upper bound of those before it\n";
    }
    text += "LEFT OUT\n";
    for (const LedgerEntry& entry : plan.ledger) {
        if (entry.kind == "prepared_again") continue;  // said above
        text += fmt::format("  {:<44} {} ({}): {}\n", entry.subject, entry.what, entry.count, entry.reason);
    }
    if (text.ends_with("LEFT OUT\n")) text += "  nothing\n";
    text += fmt::format("TIME  about {}; {} of {} cases have times of an earlier run on this machine\n",
                        clock_text(total), known, run);
    return text;
}

}  // namespace hausbench
