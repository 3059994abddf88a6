#include "harness/run/supervise.h"

#include "algorithms/session/prepared_solver.h"
#include "datasets/paths.h"
#include "harness/record/json.h"
#include "harness/run/worker_main.h"
#include "process/listener.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>

namespace hausbench {

using nlohmann::json;

namespace {

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
          listener_(worker, order.limits.memory_bytes, report.interrupted),
          chain_end_(order.chain_end(0)),
          new_shapes_(order.new_shapes()) {
        listener_.allow(seconds_to_prepare());
    }

    // Processes events until the order is carried out. Returns whether the worker can take another order.
    bool run() {
        const Limits& limits = order_.limits;
        std::string line;
        for (;;) {
            switch (listener_.hear(line)) {
                case Listener::Heard::event:
                    if (line == order_done) {
                        if (finished_ == order_.items.size()) return true;
                        return fail(RowStatus::failed, "the worker ended early");
                    }
                    if (!hear(line)) return fail(RowStatus::failed, "the worker wrote something that is not an event");
                    break;
                case Listener::Heard::interrupted:
                    return false;  // the case in flight is run again on resume
                case Listener::Heard::too_large:
                    return fail(RowStatus::out_of_memory,
                                fmt::format("more than {} MB resident", limits.memory_bytes >> 20));
                case Listener::Heard::late:
                    return fail(RowStatus::timeout,
                                prepared_
                                    ? fmt::format("killed: no answer within {} s", limits.case_seconds)
                                    : fmt::format("killed: not loaded and prepared within {} s", seconds_to_prepare()));
                case Listener::Heard::silent:
                    return fail(RowStatus::failed, "the worker closed its pipe");
                case Listener::Heard::closed:
                    if (report_.interrupted()) return false;  // the same signal may have ended both
                    const std::string how = worker_.how_it_ended();
                    return fail(worker_.signal() ? RowStatus::signal : RowStatus::failed, "ended by " + how);
            }
        }
    }

private:
    // Sets the time limit for the next event to so many seconds, and the grace.
    void allow(double seconds) { listener_.allow(seconds + grace_of(seconds)); }

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
            allow(seconds);
            return;
        }
        expect(prepared_ && finished_ < order_.items.size());
        const auto row = event.at("row").get<std::size_t>();
        const std::size_t length = chain_end_ - finished_;
        if (kind == "begin") {
            expect(!began_ && outcomes_.size() < length && row == order_.items[finished_ + outcomes_.size()].row);
            began_ = true;
            so_far_.reset();
            allow(seconds);
            return;
        }
        if (kind == "closer") {
            expect(began_ && row == order_.items[finished_ + outcomes_.size()].row);
            const Bounds bounds{number(event.at("bounds").at(0)), number(event.at("bounds").at(1))};
            if (may_bound_a_distance(bounds) && bounds.lower <= bounds.upper) so_far_ = bounds;
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
            if (prepared_)
                allow(seconds);
            else
                listener_.allow(seconds_to_prepare());
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
    // supervise(). Returns false: the worker can take no other order.
    bool fail(RowStatus status, const std::string& reason) {
        worker_.kill();
        worker_.how_it_ended();
        if (finished_ < order_.items.size()) give_up(status, reason);
        return false;
    }

    void give_up(RowStatus status, const std::string& reason) {
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
            Outcome its = outcome;
            if (began_ && so_far_) {
                its.bounds = *so_far_;
                its.reason += "; its last bounds before are kept";
            }
            report_.finished(order_.items[broken].row, its);
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
    void allow_a_pass() { allow(3 * order_.limits.case_seconds * double(chain_end_ - finished_)); }

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
    Listener listener_;
    bool prepared_ = false, began_ = false;
    std::size_t finished_ = 0,
                chain_end_;          // the present chain: items [finished_, chain_end_) of the order
    std::vector<Outcome> outcomes_;  // answers so far to the cases of the chain
    std::optional<Bounds> so_far_;   // of the case that has begun
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
