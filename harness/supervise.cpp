#include "supervise.h"

#include "paths.h"
#include "process.h"

#include <fmt/format.h>

#include <chrono>

namespace hausbench {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

namespace {

// How long past a solver's own time limit it is waited for before it is killed.
double with_grace(double seconds) { return 1.2 * seconds + 0.5; }

constexpr std::chrono::milliseconds turn(20);

struct NotAnEvent {};

class Supervisor {
public:
    Supervisor(const WorkOrder& order, const Supervision& report)
        : order_(order), report_(report), worker_(program_path(), to_json(order).dump()) {
        allow(order.limits.prepare_seconds);
    }

    std::size_t run() {
        std::string line;
        for (;;) {
            if (report_.interrupted()) return finished_;  // the case in flight is run again on resume
            if (!within_memory()) return finished_;
            switch (worker_.listen(turn, line)) {
                case WorkerProcess::Heard::nothing:
                    if (!within_time()) return finished_;
                    break;
                case WorkerProcess::Heard::closed: {
                    if (finished_ == order_.items.size()) return finished_;
                    if (!worker_.ended_within(std::chrono::seconds(1))) {
                        fail(RowStatus::failed, "the worker closed its events and went on");
                        return finished_;
                    }
                    const std::string how = worker_.end();
                    fail(worker_.signal() ? RowStatus::signal : RowStatus::failed,
                         how.empty() ? "the worker ended early" : "ended by " + how);
                    return finished_;
                }
                case WorkerProcess::Heard::line:
                    if (!hear(line)) {
                        fail(RowStatus::failed, "the worker wrote something that is not an event");
                        return finished_;
                    }
            }
        }
    }

private:
    void allow(double seconds) {
        deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    }

    // Looked at by the clock, once a turn, however much the worker has to say.
    bool within_memory() {
        if (Clock::now() < next_look_) return true;
        const std::int64_t limit = order_.limits.memory_bytes;
        if (worker_.resident_bytes() > limit) {
            fail(RowStatus::out_of_memory, fmt::format("more than {} MB resident", limit >> 20));
            return false;
        }
        next_look_ = Clock::now() + turn;
        return true;
    }

    // Looked at when all that the worker has said is heard: what it said in time counts.
    bool within_time() {
        if (Clock::now() <= deadline_) return true;
        const Limits& limits = order_.limits;
        fail(RowStatus::timeout,
             prepared_ ? fmt::format("killed: no answer within {} s", limits.case_seconds)
                       : fmt::format("killed: not loaded and prepared within {} s", limits.prepare_seconds));
        return false;
    }

    // False if the line is no event, or one out of turn. A solver may have written it: nothing in it is taken for granted.
    bool hear(const std::string& line) {
        try {
            take(json::parse(line));
            return true;
        } catch (const json::exception&) {
            return false;
        } catch (const NotAnEvent&) {
            return false;
        }
    }

    void take(const json& event) {
        const auto kind = event.at("event").get<std::string>();
        const double seconds = order_.limits.case_seconds;
        if (kind == "prepared") {
            expect(!prepared_);
            report_.prepared(event.at("left_out"));
            prepared_ = true;
            allow(with_grace(seconds));
            return;
        }
        expect(prepared_ && finished_ < order_.items.size() && event.at("row").get<std::size_t>() == row());
        expect(kind == "begin" ? !began_ : kind == "answer" ? began_ && !answered_ : answered_);
        if (kind == "begin") {
            began_ = true;
            allow(with_grace(seconds));
        } else if (kind == "answer") {
            outcome_ = outcome_from_json(event.at("outcome"));
            answered_ = true;
            allow(with_grace(3 * seconds));
        } else if (kind == "repeat") {
            const json& r = event.at("repeat");
            expect(outcome_.repeats.size() < std::size_t(order_.repeats));
            outcome_.repeats.push_back({r.at(0), number(r.at(1)), number(r.at(2)), r.at(3)});
            allow(with_grace(3 * seconds));
        } else if (kind == "trace") {
            expect(outcome_.trace.empty());
            for (const json& s : event.at("samples"))
                outcome_.trace.push_back({number(s.at(0)), number(s.at(1)), number(s.at(2))});
            if (event.at("differs").get<bool>()) {
                outcome_.status = RowStatus::failed;
                outcome_.reason =
                    "the traced run ended with other bounds than the first: the solver is not deterministic";
            }
        } else {
            expect(kind == "end");
            close(outcome_);
            allow(with_grace(seconds));
        }
    }

    // The worker has ended or has to end: the case in flight gets its row, or all cases if it never got to the first.
    void fail(RowStatus status, const std::string& reason) {
        worker_.kill();
        worker_.end();
        if (finished_ == order_.items.size()) return;  // all are answered: how it ends does not matter
        Outcome outcome;
        outcome.status = status;
        outcome.reason = reason;
        if (const std::string words = worker_.last_words(); !words.empty()) outcome.reason += "; last words: " + words;
        if (!prepared_) {
            while (finished_ < order_.items.size()) close(outcome);
        } else if (answered_) {  // the answer counts where only its timing was cut short, by time
            const bool untimed = outcome_.repeats.empty() && order_.repeats > 0;
            if (outcome_.status == RowStatus::ok && (untimed || status == RowStatus::out_of_memory)) {
                outcome_.status = status;
                outcome_.reason = (untimed ? "answered, but not while it was timed: "
                                           : "answered, but was killed while it was timed: ") +
                                  outcome.reason;
            }
            close(outcome_);
        } else {
            close(outcome);
        }
    }

    void close(Outcome outcome) {
        report_.finished(row(), std::move(outcome));
        ++finished_;
        began_ = answered_ = false;
        outcome_ = {};
    }

    std::size_t row() const { return order_.items[finished_].row; }

    static void expect(bool fits) {
        if (!fits) throw NotAnEvent{};
    }

    const WorkOrder& order_;
    const Supervision& report_;
    WorkerProcess worker_;
    Clock::time_point deadline_, next_look_ = Clock::now();
    bool prepared_ = false, began_ = false, answered_ = false;
    std::size_t finished_ = 0;
    Outcome outcome_;  // of the case in flight, as far as it is known
};

}  // namespace

std::size_t supervise(const WorkOrder& order, const Supervision& report) { return Supervisor(order, report).run(); }

}  // namespace hausbench
