#include "harness/run/runner.h"

#include "algorithms/error.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "datasets/shape_file.h"
#include "harness/check/verify.h"
#include "harness/plan/estimate.h"
#include "harness/plan/references.h"
#include "harness/result/provenance.h"
#include "harness/result/result_file.h"
#include "harness/run/describe.h"
#include "harness/run/earlier.h"
#include "harness/run/finished.h"
#include "harness/run/ledger.h"
#include "harness/run/progress.h"
#include "harness/run/side_by_side.h"
#include "harness/run/supervise.h"
#include "harness/run/time_left.h"
#include "harness/run/work_order.h"
#include "process/interrupts.h"
#include "process/memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <mutex>
#include <optional>
#include <set>

namespace hausbench {

namespace {

class Runner {
public:
    enum class Proofs { not_wanted, wanted };

    Runner(const Plan& plan, const RunOptions& options, Proofs proofs = Proofs::not_wanted)
        : plan_(plan),
          options_(options),
          proofs_(proofs),
          side_by_side_(options.jobs > 1 || options.cluster),
          finished_(plan, options.results, plan.experiment.stem + options.suffix, options.fresh,
                    {options.any_build, options.cluster, side_by_side_}),
          estimates_(options.results),
          parts_(plan.jobs.size()),
          progress_(options.quiet) {}

    RunSummary run() {
        const HoldInterrupts hold;
        refuse_to_replace(file(), plan_.experiment, options_.fresh);
        sweep();
        take_references();
        return finish();
    }

    // Runs the cases without an answer. Returns the rows of all cases that then have one; writes no result file.
    std::vector<Row> answers() {
        if (!HoldInterrupts::came()) sweep();
        std::vector<Row> rows;
        for (std::size_t i = 0; i < plan_.cases.size(); ++i) {
            if (plan_.decided.contains(i) || !finished_.kept(i, 0)) continue;
            rows.push_back(finished_.row(i));
            rows.back().is_reference = true;
        }
        return rows;
    }

private:
    void sweep() {
        for (const std::string& name : options_.collect) finished_.take_over(options_.results, name);
        if (!options_.collect.empty()) return;
        if (options_.again)
            progress_.line(fmt::format("{} finished cases are run again, as --again chooses them",
                                       finished_.forget_those(options_.again)));
        const int rounds = plan_.experiment.rounds;
        std::size_t wanted = 0;
        for (const Job& job : plan_.jobs) wanted += job.cases.size() * std::size_t(rounds);
        progress_.total(wanted);
        for (const Job& job : plan_.jobs) {
            refuse(job);
            for (int round = 0; round < rounds; ++round) part_of(job).open += places_to_run(job, round).size();
        }
        progress_.left_by([this](double gone_by) { return seconds_left(expected_parts(), gone_by); });

        if (options_.jobs > 1) return run_several();
        // Runs scene by scene, so that solvers to be compared run close in time. Every other round is reversed (ABBA).
        std::map<std::size_t, std::vector<const Job*>> by_scene;
        for (const Job& job : plan_.jobs) by_scene[job.scene].push_back(&job);
        for (auto& [scene, jobs] : by_scene) {
            for (int round = 0; round < rounds && !HoldInterrupts::came(); ++round) {
                std::optional<Child> worker;  // started anew, at other random addresses, in each round
                for (const Job* job : jobs) {
                    if (!HoldInterrupts::came()) run_job(*job, round, worker);
                }
                std::reverse(jobs.begin(), jobs.end());
            }
        }
    }

    // Computes the reference answers at the end, so that an interrupted run already has all its rows.
    void take_references() {
        if (!plan_.experiment.reference)
            ledger_.push_back({"not_run", "reference answers", "one for each scene, pose and quantity",
                               "left out by reference = false in the experiment, or by --no-reference", 1});
        if (!plan_.references) return;
        RunOptions options = options_;
        options.suffix += ".reference";
        options.quiet = true;
        options.again = nullptr;
        for (std::string& name : options.collect) name += ".reference";
        progress_.doing(fmt::format("{} reference answers", plan_.references->cases.size()));
        const auto begin = std::chrono::steady_clock::now();
        references_ = Runner(*plan_.references, options, Proofs::wanted).answers();
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        ledger_.push_back({"reference", "reference answers", "one for each scene, pose and quantity", rows_are_compared,
                           std::int64_t(references_.size()), -seconds});
    }

    std::filesystem::path file() const { return options_.results / (plan_.experiment.stem + options_.suffix + ".h5"); }

    // Gives unfinished cases of a job that cannot fit into memory the status out_of_memory; if it fits, forgets such ones.
    void refuse(const Job& job) {
        const std::string reason = does_not_fit(plan_, job, this_machine().memory_bytes);
        for (const std::size_t row : job.cases) {
            const Outcome* earlier = finished_.kept(row, 0);
            const bool refused =
                earlier && earlier->status == RowStatus::out_of_memory && earlier->reason.starts_with(not_started);
            if (reason.empty() && refused) finished_.forget(row);
            if (reason.empty() || earlier) continue;
            Outcome outcome;
            outcome.status = RowStatus::out_of_memory;
            outcome.reason = reason;
            keep(row, 0, std::move(outcome));
        }
    }

    void keep(std::size_t row, int round, Outcome outcome) {
        outcome.side_by_side = side_by_side_;
        outcome.build = build_of(plan_.cases[row].solver);
        outcome.machine = this_machine().id;
        outcome.repeats_asked = plan_.experiment.repeats;
        outcome.stages_asked = plan_.experiment.stages;
        finished_.append(row, round, outcome);
    }

    OpenWork& part_of(const Job& job) { return parts_[std::size_t(&job - plan_.jobs.data())]; }

    // Returns parts_ with expected seconds, estimated at the first call so that a short run reads no results.
    const std::vector<OpenWork>& expected_parts() {
        if (expected_) return parts_;
        for (const Job& job : plan_.jobs) {
            OpenWork& part = part_of(job);
            part.kind = plan_.cases[job.cases.front()].label;
            part.expected =
                estimates_.of(plan_, job).seconds / double(job.cases.size() * std::size_t(plan_.experiment.rounds));
        }
        expected_ = true;
        return parts_;
    }

    // Runs jobs side by side, each with all its rounds in a row, because times of such a run are not compared.
    void run_several() {
        std::vector<Demand> demands;
        for (const Job& job : plan_.jobs) {
            const JobEstimate estimate = estimates_.of(plan_, job);
            demands.push_back({estimate.seconds, plan_.cases[job.cases.front()].threads, estimate.bytes});
        }
        run_side_by_side(
            demands, Capacity(cores_here(options_.jobs), spare_bytes()),
            [&](std::size_t number, const std::vector<int>& cores) {
                for (int round = 0; round < plan_.experiment.rounds && !HoldInterrupts::came(); ++round) {
                    std::optional<Child> worker;
                    run_job(plan_.jobs[number], round, worker, cores);
                }
            },
            HoldInterrupts::came);
    }

    // Returns the cases to run in this round, as indices into Job::cases. If a case of a chain has to be run, its whole
    // chain is run. In later rounds of a search, each case is run alone, with its cutoff from round 0.
    std::vector<std::size_t> places_to_run(const Job& job, int round) const {
        std::vector<std::size_t> places;
        for (std::size_t begin = 0; begin < job.cases.size();) {
            std::size_t end = begin + 1;
            while (end < job.cases.size() && !plan_.cases[job.cases[end]].chain.empty() &&
                   !(round > 0 && searches(job)))
                ++end;
            bool wanted = false;
            for (std::size_t i = begin; i < end; ++i) wanted = wanted || finished_.is_open(job.cases[i], round);
            for (std::size_t i = begin; wanted && i < end; ++i) places.push_back(i);
            begin = end;
        }
        return places;
    }

    bool searches(const Job& job) const { return plan_.experiment.scenes[job.scene].search; }

    // Returns the smallest upper bound of the answers before this one in its search; infinity if it is the first.
    double least_upper_before(const Job& job, std::size_t place) const {
        double least = std::numeric_limits<double>::infinity();
        while (!plan_.cases[job.cases[place]].chain.empty()) {
            if (const Outcome* outcome = finished_.kept(job.cases[--place], 0))
                least = std::min(least, outcome->bounds.upper);
        }
        return least;
    }

    // Runs one round of a job on `cores`, or on any core if it is empty. Holds lock_ while it uses shared state.
    void run_job(const Job& job, int round, std::optional<Child>& worker, const std::vector<int>& cores = {}) {
        std::unique_lock lock(lock_);
        std::vector<std::size_t> places = places_to_run(job, round);
        progress_.done(job.cases.size() - places.size());
        if (places.empty()) return;
        progress_.doing(job.label);
        auto begun = std::chrono::steady_clock::now();
        std::map<RowStatus, std::size_t> statuses;
        while (!places.empty() && !HoldInterrupts::came()) {
            std::set<std::size_t> ended;
            WorkOrder work = order(job, round, places);
            work.cores = cores;
            lock.unlock();
            Supervision report;
            report.prepared = [&](const std::vector<std::string>& left_out) {
                const std::lock_guard held(lock_);
                note_left_out(job, left_out);
            };
            report.finished = [&](std::size_t row, Outcome outcome) {
                const std::lock_guard held(lock_);
                ++statuses[outcome.status];
                keep(row, round, std::move(outcome));
                end_one(job, begun);
                ended.insert(row);
            };
            report.interrupted = HoldInterrupts::came;
            supervise(work, report, worker);
            lock.lock();
            std::erase_if(places, [&](std::size_t place) { return ended.contains(job.cases[place]); });
        }
        if (!statuses.empty()) progress_.line(fmt::format("{}: {}", job.label, to_string(statuses)));
    }

    // Records that a case of the job took from `begun` until now, and sets `begun` to now.
    void end_one(const Job& job, std::chrono::steady_clock::time_point& begun) {
        const auto now = std::chrono::steady_clock::now();
        OpenWork& part = part_of(job);
        if (part.open > 0) --part.open;
        ++part.ended;
        part.took += std::chrono::duration<double>(now - begun).count();
        begun = now;
        progress_.done(1);
    }

    WorkOrder order(const Job& job, int round, const std::vector<std::size_t>& places) const {
        const Case& first = plan_.cases[job.cases[places.front()]];
        WorkOrder order;
        order.solver = first.solver;
        order.options = first.options;
        order.folder = plan_.experiment.folder();
        for (const Job::Pair& pair : job.pairs)
            order.pairs.push_back({pair.source_file, pair.target_file, pair.queries});
        order.scaled = job.exponent.has_value();
        order.exponent = job.exponent.value_or(0);
        order.limits = first.limits;
        order.round = round;
        order.repeats = plan_.experiment.repeats;
        order.build = plan_.leave_nothing_out ? Prepare::everything : Prepare::needed_only;
        order.plugins = plugin_hashes();
        std::size_t pair = 0, pair_end = job.pairs.front().cases, chain = 0, search = 0;
        const double least = least_upper_before(job, places.front());  // a fresh worker may resume a search
        for (std::size_t place : places) {
            while (place >= pair_end) pair_end += job.pairs[++pair].cases;
            const std::size_t row = job.cases[place];
            const Case& spec = plan_.cases[row];
            if (!spec.warm || spec.chain.empty()) ++chain;
            const auto marks = plan_.marks(row);
            const bool traced = round == 0 && plan_.experiment.trace &&
                                (spec.warm || !marks.empty() || find_solver(spec.solver).info.can(Ability::traces));
            order.items.push_back({row, pair, chain, spec.warm, query_of(spec), traced, marks,
                                   round == 0 ? finished_.fields_file(row) : std::filesystem::path(),
                                   round == 0 && plan_.experiment.stages});
            WorkOrder::Item& item = order.items.back();
            item.query.wanted.certificate = proofs_ == Proofs::wanted;
            if (!searches(job)) continue;
            if (round > 0) {
                item.query.cutoff = finished_.kept(row, 0)->cutoff_used;
                continue;
            }
            if (spec.chain.empty() || search == 0) ++search;
            item.search = search;
            if (search == 1) item.narrow(least);
        }
        return order;
    }

    void note_left_out(const Job& job, const std::vector<std::string>& left_out) {
        for (const std::string& what : left_out) {
            if (!noted_.insert(job.label + what).second) continue;
            ledger_.push_back(
                {"not_prepared", job.label, what, "the solver's needs() does not call for it on this scene", 1});
        }
    }

    RunSummary finish() {
        ResultFile result;
        RunSummary summary;
        std::size_t without_fields = 0;
        for (std::size_t i = 0; i < plan_.cases.size(); ++i) {
            Row row = finished_.row(i);
            if (row.fields.empty() && !row.outcome.from_trace && finished_.lacks_fields(i, row.outcome))
                ++without_fields;
            result.rows.push_back(std::move(row));
        }
        if (without_fields > 0 && !HoldInterrupts::came())
            progress_.line(fmt::format("{} rows have an answer, but the worker ended before it wrote their fields",
                                       without_fields));
        for (const ModelRow& model : plan_.models) result.models.push_back(record_of(model));
        result.ledger = ledger_of(result.rows);
        const std::size_t mine = result.rows.size();
        summary.file = file();
        const bool swept = !HoldInterrupts::came();
        HoldInterrupts::handled();  // another Ctrl-C ends reading or checking, which may take long
        std::vector<std::size_t> places;
        result.references = references_;
        for (const std::string& line : keep_earlier_rows(result, summary.file, plan_, options_.shapes_of, places))
            progress_.line(line);
        summary.kept = result.rows.size() - mine;
        progress_.doing("verifying");
        verify(result.rows, mine, result.references);
        note_unsound(result.rows, summary);
        note_unsound(result.references, summary);
        for (const Job& job : plan_.jobs) summary.open += finished_.open_cases(job);
        summary.interrupted = HoldInterrupts::came() || !swept;
        HoldInterrupts::handled();
        describe_run(result, plan_, finished_.started(), utc_now());
        summary.result = result;
        summary.result.rows.resize(mine);
        if (!places.empty()) put_in_order(result.rows, places);
        write_result(summary.file, result);
        return summary;
    }

    void verify(std::vector<Row>& rows, std::size_t mine, std::vector<Row>& references) const {
        std::map<std::string, Shape> shapes;
        verify_rows(
            rows, references,
            [&](const std::string& name) -> const Shape* {
                for (const ModelRow& model : plan_.models) {
                    if (model.info->name != name) continue;
                    const auto at = shapes.find(name);
                    return &(at != shapes.end() ? at->second
                                                : shapes[name] = read_shape(model.resolved.shape_file).shape);
                }
                return nullptr;
            },
            HoldInterrupts::came, mine);
    }

    void note_unsound(const std::vector<Row>& rows, RunSummary& summary) const {
        for (const Row& row : rows) {
            if (row.outcome.status != RowStatus::unsound) continue;
            if (unsound_expected(row.spec, plan_.experiment))
                ++summary.unsound_expected;
            else
                summary.unsound.push_back(fmt::format("{}: {}", name_of(row.spec), row.outcome.reason));
        }
    }

    std::vector<LedgerEntry> ledger_of(const std::vector<Row>& rows) const {
        std::vector<LedgerEntry> ledger = plan_.ledger;
        ledger.insert(ledger.end(), ledger_.begin(), ledger_.end());
        note_savings(plan_, finished_, rows, ledger);
        for (LedgerEntry& entry : ledger) entry.profile = plan_.experiment.profile;
        return ledger;
    }

    const Plan& plan_;
    const RunOptions options_;
    const Proofs proofs_;
    const bool side_by_side_;
    std::mutex lock_;
    Finished finished_;
    const Estimates estimates_;
    std::vector<OpenWork> parts_;  // one per job
    bool expected_ = false;        // parts_ have their kinds and expected seconds
    Progress progress_;
    std::vector<LedgerEntry> ledger_;
    std::vector<Row> references_;
    std::set<std::string> noted_;
};

}  // namespace

RunSummary run_plan(const Plan& plan, const RunOptions& options) { return Runner(plan, options).run(); }

}  // namespace hausbench
