// `measure` solves in a child process, so that a solver that crashes or hangs does not end the program. tell() runs in
// the child and sends its results through a pipe; `Waiting` receives them in the parent.
#include "algorithms/error.h"
#include "harness/commands/measurement_solve.h"
#include "harness/commands/row_texts.h"
#include "harness/record/json.h"
#include "process/child.h"
#include "process/interrupts.h"
#include "process/progress_line.h"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <optional>

namespace hausbench {

using nlohmann::json;
using std::chrono::steady_clock;

namespace {

// --- messages between the two processes ------------------------------------------------------------------------------

json result_json(const Result& r) {
    const Witness& w = r.witness;
    json statistics = json::array();
    for (const Bounds& one : r.statistics) statistics.push_back({number(one.lower), number(one.upper)});
    return {{"status", int(r.status)},
            {"bounds", {number(r.bounds.lower), number(r.bounds.upper)}},
            {"points", {w.source_point, w.target_point}},
            {"elements", {w.source_element, w.target_element}},
            {"direction", int(w.direction)},
            {"note", r.note},
            {"statistics", statistics}};
}

Result result_of(const json& j) {
    Result r;
    const int status = j.at("status"), direction = j.at("direction");
    if (status < 0 || status > int(Status::stalled) || direction < 0 || direction > 1)
        throw std::runtime_error("no such status");
    r.status = Status(status);
    r.bounds = {number(j.at("bounds").at(0)), number(j.at("bounds").at(1))};
    r.witness = {j.at("points").at(0), j.at("points").at(1), j.at("elements").at(0), j.at("elements").at(1),
                 Witness::Direction(direction)};
    r.note = j.at("note");
    for (const json& one : j.at("statistics")) r.statistics.push_back({number(one.at(0)), number(one.at(1))});
    return r;
}

// `event`: "answer", or "closer" for bounds that more work may bring closer.
json answers_json(const char* event, const Measured& m) {
    const auto optional = [](const std::optional<Result>& r) { return r ? result_json(*r) : json(); };
    return {{"event", event},
            {"result", result_json(m.result)},
            {"directions", {optional(m.forward), optional(m.backward)}},
            {"seconds", {m.prepare_seconds, m.solve_seconds, m.forward_seconds, m.backward_seconds}},
            {"peak", m.peak_bytes}};
}

void take_answers(const json& j, Measured& m) {
    m.result = result_of(j.at("result"));
    if (const json& one = j.at("directions").at(0); !one.is_null()) m.forward = result_of(one);
    if (const json& one = j.at("directions").at(1); !one.is_null()) m.backward = result_of(one);
    const json& seconds = j.at("seconds");
    m.prepare_seconds = seconds.at(0);
    m.solve_seconds = seconds.at(1);
    m.forward_seconds = seconds.at(2);
    m.backward_seconds = seconds.at(3);
    m.peak_bytes = j.at("peak");
}

json drawn_json(const DrawnFile& one) {
    return {{"event", "drawn"},
            {"file", one.file.string()},
            {"bounds", {number(one.bounds.lower), number(one.bounds.upper)}},
            {"largest", number(one.largest)},
            {"vertices", one.vertices},
            {"pieces", one.pieces},
            {"resolved", one.resolved}};
}

DrawnFile drawn_of(const json& j) {
    return {j.at("file").get<std::string>(),
            {number(j.at("bounds").at(0)), number(j.at("bounds").at(1))},
            number(j.at("largest")),
            j.at("vertices"),
            j.at("pieces"),
            j.at("resolved")};
}

enum class Trouble { input, memory, solver };

// Solves in the child process. Sends one JSON object per line to the pipe `events`: a message after each step, and an
// error message if the work fails.
void tell(const MeasureWork& work, Shape source, Shape target, Measured& measured, int events) {
    const auto send = [&](const json& event) {
        const std::string line = event.dump(-1, ' ', false, json::error_handler_t::replace) + '\n';
        for (std::size_t done = 0; done < line.size();) {
            const ssize_t n = ::write(events, line.data() + done, line.size() - done);
            if (n <= 0) ::_exit(3);  // the reader is gone
            done += std::size_t(n);
        }
    };
    const auto trouble = [&](Trouble kind, const std::string& what) {
        send({{"event", "trouble"}, {"kind", int(kind)}, {"what", one_line(what)}});
    };
    try {
        MeasureSteps steps;
        steps.prepared = [&] { send({{"event", "prepared"}}); };
        steps.answered = [&] { send(answers_json("answer", measured)); };
        steps.closer = [&] { send(answers_json("closer", measured)); };
        steps.drawn = [&] { send(drawn_json(measured.drawn.back())); };
        steps.proved = [&] { send({{"event", "certificate"}, {"proven", number(*measured.proven)}}); };
        prepare_and_solve(work, std::move(source), std::move(target), measured, steps);
        if (!measured.doubt.empty()) send({{"event", "doubt"}, {"why", one_line(measured.doubt)}});
        if (!measured.why_not_proven.empty())
            send({{"event", "no certificate"}, {"why", one_line(measured.why_not_proven)}});
        send({{"event", "end"}});
    } catch (const InputError& error) {
        trouble(Trouble::input, error.what());
    } catch (const std::bad_alloc&) {
        trouble(Trouble::memory, "");
    } catch (const std::exception& error) {
        trouble(Trouble::solver, std::string("it threw: ") + error.what());
    } catch (...) {
        trouble(Trouble::solver, "it threw something that is not a std::exception");
    }
}

// --- in the process that waits ----------------------------------------------------------------------------------------

// Stores the child's messages in `measured`, and kills the child if a step takes too long.
class Waiting {
public:
    Waiting(const MeasureWork& work, Child& child, Measured& measured)
        : limit_(work.request.time_limit),
          proof_wanted_(!work.request.certificate.empty()),
          files_wanted_(work.request.fields.empty() ? 0
                        : work.request.asks_for_h() ? 2
                                                    : 1),
          name_(work.request.statistics.empty() ? std::string(symbol(work.request.quantity()))
                                                : to_string(work.request.statistics.front())),
          child_(child),
          measured_(measured) {
        allow("it was not prepared");
    }

    void run() {
        std::string line;
        while (!ended_) {
            if (HoldInterrupts::came()) return;
            switch (child_.listen(std::chrono::milliseconds(20), line)) {
                case Child::Heard::nothing:
                    if (steady_clock::now() > deadline_) return late();
                    progress_.draw(doing());
                    break;
                case Child::Heard::closed:
                    return closed();
                case Child::Heard::line:
                    hear(line);
            }
        }
    }

private:
    std::string doing() const {
        if (answered_) return "writing and checking files";
        if (!prepared_) return "preparing";
        if (!so_far_) return "solving";
        const Bounds& bounds = so_far_->result.bounds;
        return fmt::format("solving, {} in [{}, {}] so far", name_, bound_text(bounds.lower, true),
                           bound_text(bounds.upper, false));
    }

    // Starts the time limit of the next step. If the child exceeds it, `phase` becomes the error message.
    void allow(const char* phase) {
        phase_ = phase;
        const double seconds = std::min(limit_ + grace_of(limit_), 1e9);  // a clock cannot hold infinity
        deadline_ = steady_clock::now() +
                    std::chrono::duration_cast<steady_clock::duration>(std::chrono::duration<double>(seconds));
    }

    // Kills the child and records why. An answer that has already arrived stays valid; only its fields or its
    // certificate are then missing.
    void fail(RowStatus status, const std::string& reason) {
        child_.kill();
        ended_ = true;
        if (!only_files_are_missing())
            measured_.failed = NoAnswer{status, reason};
        else if (measured_.drawn.size() < files_wanted_)
            measured_.why_not_drawn = reason;
        else if (!measured_.proven)
            measured_.why_not_proven = reason;
        else
            measured_.doubt = "it was not checked: " + reason;
    }

    bool only_files_are_missing() const { return answered_ && (proof_wanted_ || files_wanted_ > 0); }

    // The last bounds that the child has sent hold, although it has not answered.
    void late() {
        const std::string reason = fmt::format("killed: {} within the time limit of {:g} s and {:g} s of grace", phase_,
                                               limit_, grace_of(limit_));
        if (answered_ || !so_far_) return fail(RowStatus::timeout, reason);
        measured_ = std::move(*so_far_);
        Result& result = measured_.result;
        if (measured_.cutoff && result.bounds.lower > *measured_.cutoff) result.status = Status::above_cutoff;
        if (measured_.cutoff && result.bounds.upper <= *measured_.cutoff) result.status = Status::below_floor;
        result.note = fmt::format("{}; these are its bounds after {:.3g} s", reason, measured_.solve_seconds);
        answered_ = true;
        if (only_files_are_missing()) return fail(RowStatus::timeout, reason);
        child_.kill();
        ended_ = true;
    }

    void closed() {
        if (!child_.ended_within(std::chrono::seconds(1)))
            return fail(RowStatus::failed, "its process closed its pipe");
        const std::string how = child_.how_it_ended();
        fail(child_.signal() ? RowStatus::signal : RowStatus::failed,
             fmt::format("its process ended with {} before it {}", how.empty() ? "exit code 0" : how,
                         answered_ ? "wrote every requested answer" : "answered"));
    }

    // Processes a line from the child. Does not trust its content, because a solver may have written it.
    void hear(const std::string& line) {
        Trouble kind{};
        std::string what;
        try {
            const json event = json::parse(line);
            const std::string name = event.at("event");
            if (name == "prepared") {
                prepared_ = true;
                return allow("it did not answer");
            }
            if (name == "closer") return take_answers(event, so_far_.emplace(measured_));
            if (name == "answer") {
                take_answers(event, measured_);
                answered_ = true;
                return allow("its fields or its certificate were not written");
            }
            if (name == "drawn") {
                measured_.drawn.push_back(drawn_of(event));
                return allow("its fields or its certificate were not written");
            }
            if (name == "certificate") {
                measured_.proven = number(event.at("proven"));
                return allow("its certificate was not checked");
            }
            if (name == "doubt") {
                measured_.doubt = event.at("why");
                return;
            }
            if (name == "no certificate") {
                measured_.why_not_proven = event.at("why");
                return;
            }
            if (name == "end") {
                ended_ = true;
                return;
            }
            if (name != "trouble") throw std::runtime_error(name);
            kind = Trouble(event.at("kind").get<int>());
            what = event.at("what");
        } catch (const std::exception&) {
            return fail(RowStatus::failed, "its process wrote something other than an answer");
        }
        if (kind == Trouble::input && !only_files_are_missing()) throw InputError(what);
        fail(kind == Trouble::memory ? RowStatus::out_of_memory : RowStatus::failed,
             kind == Trouble::memory ? "it was refused memory that it asked for" : what);
    }

    double limit_;
    bool proof_wanted_;
    std::size_t files_wanted_;
    std::string name_;  // of what is measured
    bool prepared_ = false, answered_ = false;
    ProgressLine progress_;
    Child& child_;
    Measured& measured_;
    std::optional<Measured> so_far_;  // with the last bounds that the child has sent before it answers
    const char* phase_ = "";
    steady_clock::time_point deadline_;
    bool ended_ = false;
};

}  // namespace

double grace_of(double time_limit) { return std::max(1.0, 0.1 * time_limit); }

void solve_outside(const MeasureWork& work, Shape source, Shape target, Measured& measured) {
    const HoldInterrupts hold;  // destroyed after the child and its folder, so that Ctrl-C leaves neither behind
    Launch launch;
    launch.scratch = "worker";
    launch.work = [&](int events) {
        tell(work, std::move(source), std::move(target), measured, events);
        return 0;
    };
    Child child(std::move(launch));
    Waiting(work, child, measured).run();
    if (HoldInterrupts::came()) throw InputError("interrupted");
}

}  // namespace hausbench
