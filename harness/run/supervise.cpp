#include "harness/run/supervise.h"

#include "datasets/paths.h"
#include "harness/record/json.h"
#include "harness/run/worker_main.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace hausbench {

using nlohmann::json;
using std::chrono::steady_clock;

namespace {

// Returns how many seconds a solver with this time limit may take before it is killed. The extra time lets a solver
// that stops a little late still return its bounds.
double with_grace(double seconds) { return 1.2 * seconds + 0.5; }

constexpr std::chrono::milliseconds turn(20);  // how long to wait for an event before checking limits and interrupts

struct NotAnEvent {};

Launch launch(const WorkOrder& order) {
    Launch launch;
    launch.command = {program_path().string(), "worker", "--events"};
    launch.input = message_of(order);
    launch.more_input = true;
    launch.events = true;
    launch.scratch = "worker";
    launch.cores = order.cores;
    return launch;
}

class Supervisor {
public:
    Supervisor(const WorkOrder& order, const Supervision& report, Child& worker)
        : order_(order),
          report_(report),
          worker_(worker),
          chain_end_(order.chain_end(0)),
          new_shapes_(order.new_shapes()) {
        allow(seconds_to_prepare());
    }

    // Processes events until the order is carried out. Returns whether the worker can take another order.
    bool run() {
        std::string line;
        for (;;) {
            if (report_.interrupted()) return false;  // the case in flight is run again on resume
            if (kill_if_too_large()) return false;
            switch (worker_.listen(turn, line)) {
                case Child::Heard::nothing:
                    if (kill_if_late()) return false;
                    break;
                case Child::Heard::closed: {
                    const std::string how = worker_.how_it_ended();
                    if (report_.interrupted()) return false;  // the same signal may have ended both
                    fail(worker_.signal() ? RowStatus::signal : RowStatus::failed, "ended by " + how);
                    return false;
                }
                case Child::Heard::line:
                    if (line == order_done) {
                        if (finished_ == order_.items.size()) return true;
                        fail(RowStatus::failed, "the worker ended early");
                        return false;
                    }
                    if (!hear(line)) {
                        fail(RowStatus::failed, "the worker wrote something that is not an event");
                        return false;
                    }
            }
        }
    }

private:
    // Sets the deadline for the next event.
    void allow(double seconds) {
        deadline_ = steady_clock::now() +
                    std::chrono::duration_cast<steady_clock::duration>(std::chrono::duration<double>(seconds));
    }

    // Kills the worker if it exceeds its memory limit. Returns whether it was killed. Checks at most once per `turn`,
    // no matter how many events the worker sends.
    bool kill_if_too_large() {
        if (steady_clock::now() < next_look_) return false;
        const std::int64_t limit = order_.limits.memory_bytes;
        if (worker_.takes_more_than(limit)) {
            fail(RowStatus::out_of_memory, fmt::format("more than {} MB resident", limit >> 20));
            return true;
        }
        next_look_ = steady_clock::now() + turn;
        return false;
    }

    // Kills the worker if its deadline has passed. Returns whether it was killed. Call this only if no event is
    // waiting, because an event that was sent in time counts.
    bool kill_if_late() {
        if (steady_clock::now() <= deadline_) return false;
        const Limits& limits = order_.limits;
        fail(RowStatus::timeout,
             prepared_ ? fmt::format("killed: no answer within {} s", limits.case_seconds)
                       : fmt::format("killed: not loaded and prepared within {} s", seconds_to_prepare()));
        return true;
    }

    // Processes an event. Returns false if the line is not an event or comes out of order. Nothing in the line is
    // trusted, because a faulty solver may have written it.
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
            expect(!prepared_ && finished_ < order_.items.size());
            report_.prepared(event.at("left_out"));
            prepared_ = true;
            allow(with_grace(seconds));
            return;
        }
        expect(prepared_ && finished_ < order_.items.size());
        const auto row = event.at("row").get<std::size_t>();
        const std::size_t length = chain_end_ - finished_;
        if (kind == "begin") {
            expect(!began_ && outcomes_.size() < length && row == order_.items[finished_ + outcomes_.size()].row);
            began_ = true;
            allow(with_grace(seconds));
            return;
        }
        if (kind == "answer") {
            expect(began_ && row == order_.items[finished_ + outcomes_.size()].row);
            outcomes_.push_back(outcome_of(event.at("outcome")));
            began_ = false;
            allow_a_pass();
            return;
        }
        expect(outcomes_.size() == length);
        if (kind == "end") {
            expect(row == order_.items[finished_ + closed_].row);
            report_.finished(row, std::move(outcomes_[closed_]));
            if (++closed_ == length) next_chain();
            allow(prepared_ ? with_grace(seconds) : seconds_to_prepare());
            return;
        }
        Outcome& outcome = outcomes_[place_of(row)];
        if (kind == "repeat") {
            const json& r = event.at("repeat");
            expect(outcome.repeats.size() < std::size_t(order_.repeats));
            outcome.repeats.push_back({r.at(0), number(r.at(1)), number(r.at(2)), r.at(3)});
        } else if (kind == "fields") {
            expect(outcome.fields_sha256.empty());
            outcome.fields_sha256 = event.at("sha256").get<std::string>();
            for (const auto& [name, value] : event.at("stages").items()) outcome.extras[name] = number(value);
        } else if (kind == "proof") {
            outcome.proven_upper = number(event.at("proven"));
            outcome.facts["certificate"] = event.at("certificate").get<std::string>();
        } else {
            expect(kind == "trace" && outcome.trace.empty());
            for (const json& s : event.at("samples"))
                outcome.trace.push_back({number(s.at(0)), number(s.at(1)), number(s.at(2))});
            if (event.at("differs").get<bool>()) {
                outcome.status = RowStatus::failed;
                outcome.reason =
                    "the traced run ended with other bounds than the first: the solver is not deterministic";
            }
        }
        allow_a_pass();
    }

    // Ends the worker if it still runs, and gives outcomes to the cases that it can no longer answer, by the rules of
    // supervise().
    void fail(RowStatus status, const std::string& reason) {
        worker_.kill();
        worker_.how_it_ended();
        if (finished_ == order_.items.size()) return;  // every case is answered: how the worker ends does not matter
        Outcome outcome;
        outcome.status = status;
        outcome.reason = reason;
        if (const std::string words = worker_.last_words(); !words.empty()) outcome.reason += "; last words: " + words;
        const std::size_t length = chain_end_ - finished_;
        // The next worker may have enough memory for this pair, because it does not hold the shapes of earlier pairs.
        // But it cannot resume a chain of which some cases have ended, so the other cases get their outcomes here.
        const bool another = order_.items[finished_].pair != order_.items.front().pair;
        if (status == RowStatus::out_of_memory && another && closed_ == 0) return;
        if (!prepared_) {
            for (const std::size_t end = order_.pair_end(finished_); finished_ < end; ++finished_)
                report_.finished(order_.items[finished_].row, outcome);
        } else if (outcomes_.size() == length) {  // all answered: only their timing was cut short
            for (std::size_t k = closed_; k < length; ++k)
                report_.finished(order_.items[finished_ + k].row, cut_short(outcomes_[k], outcome));
        } else {
            const std::size_t broken = finished_ + outcomes_.size();
            report_.finished(order_.items[broken].row, outcome);
            outcome.status = RowStatus::failed;
            outcome.reason = "the chain of poses broke at an earlier pose: " + outcome.reason;
            for (std::size_t k = broken + 1; k < chain_end_; ++k) report_.finished(order_.items[k].row, outcome);
        }
    }

    // Returns the outcome of a case that was answered before the worker ended for the reason in `how`. The bounds
    // count, but the status becomes the one in `how` if no repeat was timed or if the memory ran out.
    Outcome cut_short(Outcome answered, const Outcome& how) const {
        const bool untimed = answered.repeats.empty() && order_.repeats > 0;
        if (is_timed(answered.status) && (untimed || how.status == RowStatus::out_of_memory)) {
            answered.status = how.status;
            answered.reason =
                (untimed ? "answered, but not while it was timed: " : "answered, but was killed while it was timed: ") +
                how.reason;
        }
        return answered;
    }

    // Moves on to the next chain; a cold case is a chain of its own. If the chain belongs to another pair, the worker
    // must prepare that pair first.
    void next_chain() {
        const std::size_t pair = order_.items[finished_].pair;
        finished_ = chain_end_;
        closed_ = 0;
        outcomes_.clear();
        if (finished_ == order_.items.size()) return;
        if (order_.items[finished_].pair != pair) prepared_ = false;
        chain_end_ = order_.chain_end(finished_);
    }

    // Sets a deadline that lets the worker solve the whole chain once more without sending an event. It sends none for
    // poses that are not timed, such as poses that reached their time limit.
    void allow_a_pass() { allow(with_grace(3 * order_.limits.case_seconds * double(chain_end_ - finished_))); }

    // Returns the time limit, in seconds, for loading and preparing a pair. For a matrix, the experiment's limit is
    // multiplied by the number of shapes that are not loaded yet, or by 1 if there are none.
    double seconds_to_prepare() const {
        return order_.limits.prepare_seconds * (order_.scaled ? std::max(1, new_shapes_[finished_]) : 1);
    }

    // Returns the index in outcomes_ of a row that is answered but whose "end" has not come. Throws NotAnEvent if there
    // is none.
    std::size_t place_of(std::size_t row) const {
        for (std::size_t k = closed_; k < outcomes_.size(); ++k) {
            if (order_.items[finished_ + k].row == row) return k;
        }
        throw NotAnEvent{};
    }

    static Outcome outcome_of(const json& told) {
        try {
            return outcome_from_json(told);
        } catch (const std::exception&) {  // a value that its column cannot hold
            throw NotAnEvent{};
        }
    }

    static void expect(bool fits) {
        if (!fits) throw NotAnEvent{};
    }

    const WorkOrder& order_;
    const Supervision& report_;
    Child& worker_;
    steady_clock::time_point deadline_, next_look_ = steady_clock::now();
    bool prepared_ = false, began_ = false;
    std::size_t finished_ = 0,
                chain_end_;          // the present chain: items [finished_, chain_end_) of the order
    std::vector<Outcome> outcomes_;  // answers so far to the cases of the chain
    std::size_t closed_ = 0;         // how many cases of the chain have ended
    std::vector<int> new_shapes_;    // see WorkOrder
};

}  // namespace

void supervise(const WorkOrder& order, const Supervision& report, std::optional<Child>& worker) {
    if (worker && worker->ended_within(std::chrono::milliseconds(0))) worker.reset();
    if (worker)
        worker->write(message_of(order));
    else
        worker.emplace(launch(order));
    if (!Supervisor(order, report, *worker).run()) worker.reset();
}

}  // namespace hausbench
