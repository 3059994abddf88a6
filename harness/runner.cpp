#include "runner.h"

#include "error.h"
#include "journal.h"
#include "machine.h"
#include "paths.h"
#include "process.h"
#include "progress.h"
#include "result_file.h"
#include "shape_file.h"
#include "verify.h"
#include "worker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <set>

namespace hausbench {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

namespace {

volatile std::sig_atomic_t interrupted = 0;

// Ctrl-C sets a flag for as long as this lives.
class Interrupts {
public:
    Interrupts() {
        interrupted = 0;
        struct sigaction action {};
        action.sa_handler = [](int) { interrupted = 1; };
        sigaction(SIGINT, &action, &before_[0]);
        sigaction(SIGTERM, &action, &before_[1]);
    }
    ~Interrupts() {
        sigaction(SIGINT, &before_[0], nullptr);
        sigaction(SIGTERM, &before_[1], nullptr);
    }

private:
    struct sigaction before_[2];
};

// How long past a solver's own time limit the runner waits before it kills.
double with_grace(double seconds) { return 1.2 * seconds + 0.5; }

struct NotAnEvent {};

// Everything that is kept between two events of one worker.
struct InFlight {
    bool began = false, answered = false;
    std::size_t row = 0;
    Outcome outcome;
};

class Runner {
public:
    Runner(const Plan& plan, const RunOptions& options)
        : plan_(plan),
          options_(options),
          journal_((std::filesystem::create_directories(options.results), options.results / (plan.experiment.stem + options.suffix + ".journal")), options.fresh),
          progress_(options.quiet) {}

    RunSummary run() {
        Interrupts interrupts;
        const int rounds = plan_.experiment.rounds;
        std::size_t wanted = 0;
        for (const Job& job : plan_.jobs) wanted += job.cases.size() * std::size_t(rounds);
        progress_.total(wanted);

        // Scene by scene, so that solvers that are compared run close in time; every other round in reverse (ABBA).
        std::map<std::size_t, std::vector<const Job*>> by_scene;
        for (const Job& job : plan_.jobs) by_scene[job.scene].push_back(&job);
        for (auto& [scene, jobs] : by_scene) {
            for (int round = 0; round < rounds && !interrupted; ++round) {
                for (const Job* job : jobs) {
                    if (interrupted) break;
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
        if (!options_.any_build && (outcome.build != build_of(plan_.cases[row].solver) || outcome.machine != this_machine().id)) return nullptr;
        // Asked for more than that run gave: an experiment's repeats and trace are not part of a case's identity.
        const bool timed = outcome.status == "ok" || outcome.status == "floor";
        if (timed && outcome.repeats.empty() && plan_.experiment.repeats > 0) return nullptr;
        if (round == 0 && outcome.status == "ok" && outcome.trace.empty() && !plan_.marks(row).empty()) return nullptr;
        return &outcome;
    }

    void run_job(const Job& job, int round) {
        std::vector<std::size_t> rows;
        for (std::size_t row : job.cases) {
            if (kept(row, round)) continue;
            const Outcome* first = round == 0 ? nullptr : kept(row, 0);
            if (round > 0 && !(first && (first->status == "ok" || first->status == "floor"))) continue;  // nothing to time
            rows.push_back(row);
        }
        progress_.done(job.cases.size() - rows.size());
        if (rows.empty()) return;
        progress_.doing(job.label);
        std::map<std::string, int> statuses;
        while (!rows.empty() && !interrupted) {
            const std::size_t finished = run_worker(job, round, rows, statuses);
            rows.erase(rows.begin(), rows.begin() + std::ptrdiff_t(finished));
        }
        std::string text;
        for (const auto& [status, count] : statuses) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, status);
        if (!text.empty()) progress_.line(fmt::format("{}: {}", job.label, text));
    }

    WorkOrder order(const Job& job, int round, const std::vector<std::size_t>& rows) const {
        const Case& first = plan_.cases[rows.front()];
        WorkOrder order;
        order.solver = first.solver;
        order.options = first.options;
        order.source_file = job.source_file;
        order.target_file = job.target_file;
        order.queries = job.queries;
        order.limits = first.limits;
        order.round = round;
        order.repeats = plan_.experiment.repeats;
        order.leave = plan_.leave_nothing_out ? Leave::nothing_out : Leave::out_what_is_not_needed;
        order.plugins = plugin_hashes();
        for (std::size_t row : rows) {
            const Case& asked = plan_.cases[row];
            const auto marks = plan_.marks(row);
            order.items.push_back({row, asked.pose, asked.resolved_tolerance(), round == 0 && traces(row), marks});
        }
        return order;
    }

    bool traces(std::size_t row) const {
        if (!plan_.experiment.trace) return false;
        for (const auto& [coarse, from] : plan_.traced) {
            if (from.of == row && !from.exact) return true;
        }
        return false;
    }

    // Returns how many of the rows it finished, in order; at least one unless interrupted.
    std::size_t run_worker(const Job& job, int round, const std::vector<std::size_t>& rows, std::map<std::string, int>& statuses) {
        const Limits& limits = plan_.cases[rows.front()].limits;
        WorkerProcess worker(program_path(), to_json(order(job, round, rows)).dump());
        InFlight now;
        std::size_t finished = 0;
        bool prepared = false;
        Clock::time_point deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(limits.prepare_seconds));
        const auto allow = [&](double seconds) {
            deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
        };
        const auto close_case = [&](std::size_t row, Outcome outcome) {
            outcome.build = build_of(plan_.cases[row].solver);
            outcome.machine = this_machine().id;
            ++statuses[outcome.status];
            journal_.append({plan_.cases[row].identity, round}, outcome);
            progress_.done(1);
            ++finished;
        };
        // The worker is gone or has to go: the case in flight gets its row, or all of them if it never got to the first.
        const auto fail = [&](const std::string& status, const std::string& reason) {
            worker.kill();
            worker.end();
            if (finished == rows.size()) return;  // all are answered: how it ends is its own affair
            Outcome outcome;
            outcome.status = status;
            outcome.reason = reason;
            if (const std::string words = worker.last_words(); !words.empty()) outcome.reason += "; last words: " + words;
            if (!prepared) {
                while (finished < rows.size()) close_case(rows[finished], outcome);
            } else if (now.answered) {  // the answer counts; only its timing was cut short
                if (now.outcome.status == "ok" && now.outcome.repeats.empty() && plan_.experiment.repeats > 0) {
                    now.outcome.status = status;
                    now.outcome.reason = "answered, but not while it was timed: " + outcome.reason;
                }
                close_case(now.row, now.outcome);
            } else {
                close_case(now.began ? now.row : rows[finished], outcome);
            }
        };

        std::string line;
        for (;;) {
            if (interrupted) return finished;  // the case in flight is run again on resume
            const auto heard = worker.listen(std::chrono::milliseconds(20), line);
            if (heard == WorkerProcess::Heard::nothing) {
                if (worker.resident_bytes() > limits.memory_bytes) {
                    fail("out_of_memory", fmt::format("more than {} MB resident", limits.memory_bytes >> 20));
                    return finished;
                }
                if (Clock::now() > deadline) {
                    fail("timeout", prepared ? fmt::format("killed: no answer within {} s", limits.case_seconds)
                                             : fmt::format("killed: not loaded and prepared within {} s", limits.prepare_seconds));
                    return finished;
                }
                continue;
            }
            if (heard == WorkerProcess::Heard::closed) {
                if (finished == rows.size()) return finished;
                if (!worker.ended_within(std::chrono::seconds(1))) {
                    fail("failed", "the worker closed its events and went on");
                    return finished;
                }
                const std::string how = worker.end();
                fail(worker.signal() ? "signal" : "failed", how.empty() ? "the worker ended early" : "ended by " + how);
                return finished;
            }
            bool garbled = false;
            try {
                // A solver may have written this: nothing in it is taken for granted.
                const json event = json::parse(line);
                const auto kind = event.at("event").get<std::string>();
                const auto expect = [](bool fits) {
                    if (!fits) throw NotAnEvent{};
                };
                if (kind != "prepared") {
                    expect(prepared && finished < rows.size() && event.at("row").get<std::size_t>() == rows[finished]);
                    expect(kind == "begin" ? !now.began : kind == "answer" ? now.began && !now.answered : now.answered);
                }
                if (kind == "prepared") {
                    expect(!prepared);
                    note_left_out(job, event.at("left_out"));
                    prepared = true;
                    allow(with_grace(limits.case_seconds));
                } else if (kind == "begin") {
                    now = {true, false, rows[finished], {}};
                    allow(with_grace(limits.case_seconds));
                } else if (kind == "answer") {
                    now.outcome = outcome_from_json(event.at("outcome"));
                    now.answered = true;
                    allow(with_grace(3 * limits.case_seconds));
                } else if (kind == "repeat") {
                    const json& r = event.at("repeat");
                    expect(now.outcome.repeats.size() < std::size_t(plan_.experiment.repeats));
                    now.outcome.repeats.push_back({r.at(0), number(r.at(1)), number(r.at(2)), r.at(3)});
                    allow(with_grace(3 * limits.case_seconds));
                } else if (kind == "trace") {
                    expect(now.outcome.trace.empty());
                    for (const json& s : event.at("samples")) now.outcome.trace.push_back({number(s.at(0)), number(s.at(1)), number(s.at(2))});
                    if (event.at("differs").get<bool>()) {
                        now.outcome.status = "failed";
                        now.outcome.reason = "the traced run ended with other bounds than the first: the solver is not deterministic";
                    }
                } else if (kind == "end") {
                    close_case(now.row, now.outcome);
                    now = {};
                    allow(with_grace(limits.case_seconds));
                } else {
                    throw NotAnEvent{};
                }
            } catch (const json::exception&) {
                garbled = true;
            } catch (const NotAnEvent&) {
                garbled = true;
            }
            if (garbled) {
                fail("failed", "the worker wrote something that is not an event");
                return finished;
            }
        }
    }

    void note_left_out(const Job& job, const json& left_out) {
        for (const json& what : left_out) {
            if (!noted_.insert(job.label + what.get<std::string>()).second) continue;
            ledger_.push_back({"not_prepared", job.label, what, "the solver's needs() does not call for it on this scene", 1});
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
        const Outcome* first = kept(row, 0);
        if (!first) {
            Outcome outcome;
            outcome.reason = "not run: the sweep was interrupted; run it again to resume";
            return outcome;
        }
        Outcome outcome = *first;
        for (int round = 1; round < plan_.experiment.rounds; ++round) {
            const Outcome* next = kept(row, round);
            if (!next) continue;
            outcome.repeats.insert(outcome.repeats.end(), next->repeats.begin(), next->repeats.end());
            if (next->status != outcome.status || next->bounds.lower != outcome.bounds.lower || next->bounds.upper != outcome.bounds.upper) {
                outcome.status = "failed";
                outcome.reason = fmt::format("round {} gave {} [{}, {}]: the solver is not deterministic", round, next->status,
                                             next->bounds.lower, next->bounds.upper);
            }
        }
        return outcome;
    }

    Outcome read_off(std::size_t row, const FromTrace& from) const {
        Outcome outcome = gather(from.of);
        outcome.from_trace = true;
        if (from.exact) {
            const double gap = plan_.cases[row].resolved_tolerance().gap(outcome.bounds.lower);
            if (outcome.status == "floor" && outcome.bounds.gap() <= gap) outcome.status = "ok", outcome.reason.clear(), outcome.solver_status = "converged";
            return outcome;
        }
        const double gap = plan_.cases[row].resolved_tolerance().value;
        outcome.repeats.clear();
        for (const TraceSample& sample : outcome.trace) {
            if (!(sample.upper - sample.lower <= gap)) continue;
            outcome.bounds = {sample.lower, sample.upper};
            outcome.solve_seconds = sample.seconds;
            outcome.status = "ok";
            outcome.reason.clear();
            outcome.solver_status = to_string(Status::converged);
            break;
        }
        outcome.trace.clear();
        return outcome;
    }

    // Each row read off another run would have cost its first answer and its timed repeats.
    void note_time_saved(ResultFile& result) const {
        const Experiment& e = plan_.experiment;
        std::map<std::string, double> saved;
        for (const Row& row : result.rows) {
            if (!row.outcome.from_trace || !std::isfinite(row.outcome.solve_seconds)) continue;
            saved[fmt::format("{} on {}", row.asked.label, row.asked.scene)] += row.outcome.solve_seconds * e.rounds * (1 + e.repeats);
        }
        for (LedgerEntry& entry : result.ledger) {
            const auto at = saved.find(entry.subject);
            if (entry.what != coarser_tolerances || at == saved.end()) continue;
            entry.seconds_saved = at->second;
            at->second = 0;  // several options of one solver share a label: their sum stands at the first
        }
    }

    RunSummary finish() {
        ResultFile result;
        RunSummary summary;
        for (std::size_t i = 0; i < plan_.cases.size(); ++i) {
            const auto from = plan_.traced.find(i);
            result.rows.push_back({plan_.cases[i], from == plan_.traced.end() ? gather(i) : read_off(i, from->second), {}});
        }
        progress_.doing("verifying");
        std::map<std::string, Shape> shapes;
        verify_rows(result.rows, [&](const std::string& name) -> const Shape* {
            for (const ModelRow& model : plan_.models) {
                if (model.info->name != name) continue;
                const auto at = shapes.find(name);
                return &(at != shapes.end() ? at->second : shapes[name] = read_shape(model.resolved.shape_file).shape);
            }
            return nullptr;
        });
        for (const Row& row : result.rows) ++summary.statuses[row.outcome.status];
        for (const ModelRow& model : plan_.models) result.models.push_back(record_of(model));
        result.ledger = plan_.ledger;
        result.ledger.insert(result.ledger.end(), ledger_.begin(), ledger_.end());
        note_time_saved(result);
        summary.file = options_.results / (plan_.experiment.stem + options_.suffix + ".h5");
        summary.interrupted = interrupted != 0;
        describe_run(result, plan_.experiment, journal_.started(), utc_now());
        write_result(summary.file, result);
        return summary;
    }

    const Plan& plan_;
    const RunOptions& options_;
    Journal journal_;
    Progress progress_;
    std::vector<LedgerEntry> ledger_;
    std::set<std::string> noted_;
};

}  // namespace

RunSummary run_plan(const Plan& plan, const RunOptions& options) { return Runner(plan, options).run(); }

}  // namespace hausbench
