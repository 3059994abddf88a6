#include "run/runner.h"

#include "check/verify.h"
#include "error.h"
#include "hash.h"
#include "process/interrupts.h"
#include "registry.h"
#include "result/field_file.h"
#include "result/provenance.h"
#include "result/result_file.h"
#include "run/describe.h"
#include "run/earlier.h"
#include "run/journal.h"
#include "run/progress.h"
#include "run/rounds.h"
#include "run/supervise.h"
#include "run/worker.h"
#include "session.h"
#include "shape_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

namespace hausbench {

using nlohmann::json;

namespace {

const std::filesystem::path& made_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (!error && !std::filesystem::is_directory(folder, error) && !error)
        error = std::make_error_code(std::errc::not_a_directory);
    if (error)
        throw InputError(fmt::format("{}: cannot be made a folder for results ({}): name another with --results",
                                     folder.string(), error.message()));
    return folder;
}

class Runner {
public:
    Runner(const Plan& plan, const RunOptions& options)
        : plan_(plan),
          options_(options),
          journal_(made_folder(options.results) / (plan.experiment.stem + options.suffix + ".journal"),
                   options.fresh && plan.whole),
          fields_(options.results / (plan.experiment.stem + options.suffix + ".fields")),
          progress_(options.quiet) {
        if (options.fresh) {
            std::set<std::string> asked;
            for (const Case& one : plan.cases) asked.insert(one.identity);
            journal_.forget(asked);
            for (std::size_t row = 0; row < plan.cases.size(); ++row) {
                if (const auto file = fields_file(row); !file.empty()) std::filesystem::remove(file);
            }
        }
        if (plan.experiment.fields) made_folder(fields_);
    }

    RunSummary run() {
        const HoldInterrupts hold;
        const int rounds = plan_.experiment.rounds;
        std::size_t wanted = 0;
        for (const Job& job : plan_.jobs) wanted += job.cases.size() * std::size_t(rounds);
        progress_.total(wanted);

        // Scene by scene, so that solvers that are compared run close in time; every other round in reverse (ABBA).
        std::map<std::size_t, std::vector<const Job*>> by_scene;
        for (const Job& job : plan_.jobs) by_scene[job.scene].push_back(&job);
        for (auto& [scene, jobs] : by_scene) {
            for (int round = 0; round < rounds && !HoldInterrupts::came(); ++round) {
                for (const Job* job : jobs) {
                    if (HoldInterrupts::came()) break;
                    run_job(*job, round);
                }
                std::reverse(jobs.begin(), jobs.end());
            }
        }
        return finish();
    }

private:
    const Outcome* kept(std::size_t row, int round) const {
        const auto at = journal_.outcomes().find({plan_.cases[row].identity, round});
        if (at == journal_.outcomes().end()) return nullptr;
        const Outcome& outcome = at->second;
        if (!options_.any_build &&
            (outcome.build != build_of(plan_.cases[row].solver) || outcome.machine != this_machine().id))
            return nullptr;
        // Asked for more than that run gave: an experiment's repeats and trace are not part of a case's identity.
        if (is_timed(outcome.status) && outcome.repeats_asked < plan_.experiment.repeats) return nullptr;
        if (round == 0 && is_timed(outcome.status) && plan_.experiment.stages && !outcome.stages_asked) return nullptr;
        // Of a search whose first round was run again since.
        const Outcome* first = round > 0 ? kept(row, 0) : nullptr;
        if (first && first->cutoff_used != outcome.cutoff_used) return nullptr;
        const bool traced = !plan_.marks(row).empty() || traces_chain(row);
        if (round == 0 && outcome.status == RowStatus::ok && outcome.trace.empty() && traced) return nullptr;
        return &outcome;
    }

    bool traces_chain(std::size_t row) const {
        const Case& asked = plan_.cases[row];
        return asked.warm && plan_.experiment.trace && find_solver(asked.solver).info.traces;
    }

    // Where the fields of a row belong; empty: it has none.
    std::filesystem::path fields_file(std::size_t row) const {
        const Case& asked = plan_.cases[row];
        if (!plan_.experiment.fields || is_surface(asked.source) || is_surface(asked.target)) return {};
        return fields_ / (asked.identity + ".bin");
    }

    bool is_surface(const std::string& name) const {
        return std::any_of(plan_.models.begin(), plan_.models.end(), [&](const ModelRow& model) {
            return model.info->name == name && model.resolved.kind == ShapeKind::surface;
        });
    }

    // Asked for, and their file is missing or another one than the row names.
    bool lacks_fields(std::size_t row, const Outcome& outcome) const {
        const auto file = fields_file(row);
        if (file.empty() || !is_timed(outcome.status)) return false;
        return !std::filesystem::is_regular_file(file) || sha256_of_file(file) != outcome.fields_sha256;
    }

    // None where they were not asked for, stand at a finer row, or cannot be had: the answer counts all the same.
    Fields fields_of(std::size_t row, Outcome& outcome) const {
        const auto file = fields_file(row);
        if (!file.empty() && !outcome.from_trace && !outcome.fields_sha256.empty()) {
            if (auto fields = read_fields(file, outcome.fields_sha256)) return std::move(*fields);
        }
        outcome.fields_sha256.clear();
        return {};
    }

    // Of the job's cases, those to run in this round, as places in Job::cases. A warm chain is run as a whole, from its head; so is a
    // search, but only once: later rounds ask with the cutoffs of round 0.
    std::vector<std::size_t> places_to_run(const Job& job, int round) const {
        std::vector<std::size_t> places;
        for (std::size_t begin = 0; begin < job.cases.size();) {
            std::size_t end = begin + 1;
            while (end < job.cases.size() && !plan_.cases[job.cases[end]].chain.empty() &&
                   !(round > 0 && searches(job)))
                ++end;
            bool wanted = false;
            for (std::size_t i = begin; i < end; ++i) wanted = wanted || to_run(job.cases[i], round);
            for (std::size_t i = begin; wanted && i < end; ++i) places.push_back(i);
            begin = end;
        }
        return places;
    }

    bool searches(const Job& job) const { return plan_.experiment.scenes[job.scene].search; }

    // Of the answers before this one in its search.
    double least_upper_before(const Job& job, std::size_t place) const {
        double least = std::numeric_limits<double>::infinity();
        while (!plan_.cases[job.cases[place]].chain.empty()) {
            if (const Outcome* outcome = kept(job.cases[--place], 0)) least = std::min(least, outcome->bounds.upper);
        }
        return least;
    }

    bool to_run(std::size_t row, int round) const {
        if (const Outcome* outcome = kept(row, round)) return round == 0 && lacks_fields(row, *outcome);
        if (round == 0) return true;
        const Outcome* first = kept(row, 0);
        return first && is_timed(first->status);  // else nothing to time
    }

    void run_job(const Job& job, int round) {
        std::vector<std::size_t> places = places_to_run(job, round);
        progress_.done(job.cases.size() - places.size());
        if (places.empty()) return;
        progress_.doing(job.label);
        std::map<RowStatus, std::size_t> statuses;
        while (!places.empty() && !HoldInterrupts::came()) {
            std::set<std::size_t> finished;
            supervise(order(job, round, places),
                      {.prepared = [&](const json& left_out) { note_left_out(job, left_out); },
                       .finished =
                           [&](std::size_t row, Outcome outcome) {
                               outcome.build = build_of(plan_.cases[row].solver);
                               outcome.machine = this_machine().id;
                               outcome.repeats_asked = plan_.experiment.repeats;
                               outcome.stages_asked = plan_.experiment.stages;
                               ++statuses[outcome.status];
                               journal_.append({plan_.cases[row].identity, round}, outcome);
                               progress_.done(1);
                               finished.insert(row);
                           },
                       .interrupted = HoldInterrupts::came});
            std::erase_if(places, [&](std::size_t place) { return finished.contains(job.cases[place]); });
        }
        if (!statuses.empty()) progress_.line(fmt::format("{}: {}", job.label, to_string(statuses)));
    }

    WorkOrder order(const Job& job, int round, const std::vector<std::size_t>& places) const {
        const Case& first = plan_.cases[job.cases[places.front()]];
        WorkOrder order;
        order.solver = first.solver;
        order.options = first.options;
        order.folder = plan_.experiment.folder();
        for (const Job::Pair& pair : job.pairs)
            order.pairs.push_back({pair.source_file, pair.target_file, pair.queries});
        order.exponent = job.exponent;
        order.limits = first.limits;
        order.round = round;
        order.repeats = plan_.experiment.repeats;
        order.leave = plan_.leave_nothing_out ? Leave::nothing_out : Leave::out_what_is_not_needed;
        order.plugins = plugin_hashes();
        std::size_t pair = 0, pair_end = job.pairs.front().cases, chain = 0, search = 0;
        const double least = least_upper_before(job, places.front());  // of a search that broke off
        for (std::size_t place : places) {
            while (place >= pair_end) pair_end += job.pairs[++pair].cases;
            const std::size_t row = job.cases[place];
            const Case& asked = plan_.cases[row];
            if (!asked.warm || asked.chain.empty()) ++chain;
            const auto marks = plan_.marks(row);
            const bool traced = round == 0 && plan_.experiment.trace && (asked.warm || !marks.empty());
            order.items.push_back({row, pair, chain, asked.warm, asked.quantity, asked.pose, asked.target_pose,
                                   asked.resolved_tolerance(), asked.floor, asked.cutoff, asked.budget, asked.threads,
                                   traced, marks, round == 0 ? fields_file(row) : std::filesystem::path(),
                                   round == 0 && plan_.experiment.stages});
            if (!searches(job)) continue;
            WorkOrder::Item& item = order.items.back();
            if (round > 0) {
                item.cutoff = kept(row, 0)->cutoff_used;
                continue;
            }
            if (asked.chain.empty() || search == 0) ++search;
            item.search = search;
            if (search == 1) item.narrow(least);
        }
        return order;
    }

    void note_left_out(const Job& job, const json& left_out) {
        for (const json& what : left_out) {
            if (!noted_.insert(job.label + what.get<std::string>()).second) continue;
            ledger_.push_back(
                {"not_prepared", job.label, what, "the solver's needs() does not call for it on this scene", 1});
        }
    }

    // One outcome a row: the rounds' repeats together.
    Outcome gather(std::size_t row) const {
        if (const auto at = plan_.decided.find(row); at != plan_.decided.end()) {
            Outcome outcome = at->second;
            outcome.build = build_of(plan_.cases[row].solver);
            outcome.machine = this_machine().id;
            return outcome;
        }
        if (!kept(row, 0)) {
            Outcome outcome;
            outcome.reason = not_run_yet;
            return outcome;
        }
        std::map<int, const Outcome*> rounds;
        for (int round = 0; round < plan_.experiment.rounds; ++round) {
            if (const Outcome* outcome = kept(row, round)) rounds[round] = outcome;
        }
        return gather_rounds(rounds);
    }

    Outcome read_off(std::size_t row, const FromTrace& from) const {
        const Outcome fine = gather(from.of);
        const double gap = plan_.cases[row].resolved_tolerance().gap(fine.bounds.lower);
        return from.ignores_tolerance ? read_off_answer(fine, gap) : read_off_trace(fine, gap);
    }

    // Each row read off another run would have cost its first answer and its timed repeats.
    void note_time_saved(const std::vector<Row>& rows, std::vector<LedgerEntry>& ledger) const {
        const Experiment& e = plan_.experiment;
        std::map<std::string, double> saved;
        for (const Row& row : rows) {
            if (!row.outcome.from_trace || !std::isfinite(row.outcome.solve_seconds)) continue;
            saved[fmt::format("{} on {}", shown(row.asked), row.asked.scene)] +=
                row.outcome.solve_seconds * e.rounds * (1 + e.repeats);
        }
        for (LedgerEntry& entry : ledger) {
            const auto at = saved.find(entry.subject);
            if (entry.what != coarser_tolerances || at == saved.end()) continue;
            entry.seconds_saved = at->second;
            at->second = 0;  // several tolerances of one subject: their sum stands at the first
        }
    }

    // A worker prepares once and then answers every pose: what preparing again for each of them would have cost.
    void note_structures_reused(std::vector<LedgerEntry>& ledger) const {
        for (const Job& job : plan_.jobs) {
            if (job.exponent) {
                note_shapes_shared(job, ledger);
                continue;
            }
            if (job.pairs.front().queries.target_copied) continue;  // see note_copies() in plan.cpp
            std::set<double> builds;  // one a process: a worker that died, or an earlier run, prepared on its own
            std::set<int> poses;
            for (std::size_t row : job.cases) {
                const Outcome* outcome = kept(row, 0);
                if (!outcome || outcome->preparation.empty() || !std::isfinite(outcome->prepare_seconds)) continue;
                builds.insert(outcome->prepare_seconds);
                poses.insert(plan_.cases[row].pose_index);
            }
            if (poses.size() <= builds.size()) continue;
            const auto left_out = poses.size() - builds.size();
            const double mean = std::accumulate(builds.begin(), builds.end(), 0.0) / double(builds.size());
            ledger.push_back(
                {"not_prepared", job.label, structures_for_each_pose,
                 fmt::format("built {} and used for all {} poses",
                             builds.size() == 1 ? "once" : fmt::format("{} times", builds.size()), poses.size()),
                 std::int64_t(left_out), mean * double(left_out)});
        }
    }

    // A worker of a matrix prepares each shape once for all its pairs.
    void note_shapes_shared(const Job& job, std::vector<LedgerEntry>& ledger) const {
        struct Use {
            int built = 0, shared = 0;
            double saved = 0;
            std::set<std::filesystem::path> shapes;
        };
        std::map<std::string, Use> uses;
        std::size_t place = 0;
        for (const Job::Pair& pair : job.pairs) {
            const Outcome* outcome = kept(job.cases[place], 0);  // any case of the pair says the same
            place += pair.cases;
            if (!outcome) continue;
            for (const Preparation& part : outcome->preparation) {
                if (part.round != 0 || part.name.starts_with("solver")) continue;
                const std::size_t side =
                    part.name.find(' ') + 1;  // "target BVH", or "target BVH (B to A)", which is over A
                const std::size_t back = part.name.find(" (B to A)");
                const bool over_target = part.name.starts_with("target") == (back == std::string::npos);
                Use& use = uses[part.name.substr(side, back - side)];
                ++(part.shared ? use.shared : use.built);
                if (part.shared) use.saved += part.seconds;
                use.shapes.insert(over_target ? pair.target_file : pair.source_file);
            }
        }
        for (const auto& [name, use] : uses) {
            if (use.shared == 0) continue;
            const std::string again = std::size_t(use.built) == use.shapes.size()
                                          ? ""
                                          : fmt::format(", built {} times, by several workers or runs", use.built);
            ledger.push_back({"not_prepared", job.label, structures_for_each_pair,
                              fmt::format("{}: built over {} shapes and used {} times by {} pairs{}", name,
                                          use.shapes.size(), use.built + use.shared, job.pairs.size(), again),
                              use.shared, use.saved});
        }
    }

    RunSummary finish() {
        ResultFile result;
        RunSummary summary;
        std::size_t without_fields = 0;
        for (std::size_t i = 0; i < plan_.cases.size(); ++i) {
            const auto from = plan_.traced.find(i);
            Row row{plan_.cases[i], from == plan_.traced.end() ? gather(i) : read_off(i, from->second), {}};
            row.fields = fields_of(i, row.outcome);
            if (row.fields.empty() && !row.outcome.from_trace && lacks_fields(i, row.outcome)) ++without_fields;
            result.rows.push_back(std::move(row));
        }
        if (without_fields > 0 && !HoldInterrupts::came())
            progress_.line(fmt::format("{} rows have an answer, but the worker ended before it wrote their fields",
                                       without_fields));
        for (const ModelRow& model : plan_.models) result.models.push_back(record_of(model));
        result.ledger = ledger_of(result.rows);
        const std::size_t mine = result.rows.size();
        summary.file = options_.results / (plan_.experiment.stem + options_.suffix + ".h5");
        std::vector<std::size_t> places;
        keep_earlier_rows(result, summary.file, places);
        summary.kept = result.rows.size() - mine;
        progress_.doing("verifying");
        const bool swept = !HoldInterrupts::came();
        HoldInterrupts::handled();  // the next Ctrl-C ends the checking, which can take long, too
        std::map<std::string, Shape> shapes;
        verify_rows(
            result.rows,
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
        for (const Row& row : result.rows) {
            if (row.outcome.status != RowStatus::unsound) continue;
            if (unsound_expected(row.asked, plan_.experiment))
                ++summary.unsound_expected;
            else
                summary.unsound.push_back(fmt::format("{}: {}", name_of(row.asked), row.outcome.reason));
        }
        summary.interrupted = HoldInterrupts::came() || !swept;
        HoldInterrupts::handled();
        describe_run(result, plan_, journal_.started(), utc_now());
        summary.result = result;
        summary.result.rows.resize(mine);
        if (!places.empty()) put_in_order(result.rows, places);
        write_result(summary.file, result);
        return summary;
    }

    static void put_in_order(std::vector<Row>& rows, const std::vector<std::size_t>& places) {
        std::vector<std::size_t> order(rows.size());
        std::iota(order.begin(), order.end(), 0);
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return places[a] < places[b]; });
        std::vector<Row> sorted;
        for (const std::size_t i : order) sorted.push_back(std::move(rows[i]));
        rows = std::move(sorted);
    }

    std::vector<LedgerEntry> ledger_of(const std::vector<Row>& rows) const {
        std::vector<LedgerEntry> ledger = plan_.ledger;
        ledger.insert(ledger.end(), ledger_.begin(), ledger_.end());
        note_time_saved(rows, ledger);
        note_structures_reused(ledger);
        for (LedgerEntry& entry : ledger) entry.profile = plan_.experiment.profile;
        return ledger;
    }

    // A file that cannot be read is put aside: whoever knows what it is may still want it.
    void keep_earlier_rows(ResultFile& result, const std::filesystem::path& file, std::vector<std::size_t>& places) {
        if (!std::filesystem::exists(file)) return;
        try {
            for (const std::string& line : keep_earlier(result, read_result(file), plan_, places)) progress_.line(line);
        } catch (const InputError& error) {
            const std::filesystem::path aside = file.string() + ".unreadable";
            std::filesystem::rename(file, aside);
            progress_.line(fmt::format("{}; it is {} now", error.what(), aside.string()));
        }
    }

    const Plan& plan_;
    const RunOptions& options_;
    Journal journal_;
    std::filesystem::path fields_;  // folder
    Progress progress_;
    std::vector<LedgerEntry> ledger_;
    std::set<std::string> noted_;
};

}  // namespace

RunSummary run_plan(const Plan& plan, const RunOptions& options) { return Runner(plan, options).run(); }

}  // namespace hausbench
