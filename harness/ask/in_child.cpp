#include "harness/ask/in_child.h"

#include "algorithms/error.h"
#include "algorithms/session/adapter.h"
#include "algorithms/session/prepared_solver.h"
#include "harness/ask/json_values.h"
#include "process/interrupts.h"
#include "process/listener.h"
#include "process/memory.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace hausbench {

using nlohmann::json;

namespace {

// --- answers as JSON ---------------------------------------------------------------------------------------------------

json json_of(const Result& r) {
    const Witness& w = r.witness;
    json statistics = json::array();
    for (const Bounds& bounds : r.statistics) statistics.push_back({number(bounds.lower), number(bounds.upper)});
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
    for (const json& bounds : j.at("statistics")) r.statistics.push_back({number(bounds.at(0)), number(bounds.at(1))});
    return r;
}

json json_of(const Answer& a) {
    const auto optional = [](const std::optional<Result>& r) { return r ? json_of(*r) : json(); };
    return {{"result", json_of(a.result)},
            {"directions", {optional(a.forward), optional(a.backward)}},
            {"seconds", {a.prepare_seconds, a.solve_seconds, a.forward_seconds, a.backward_seconds}}};
}

Answer answer_of(const json& j) {
    Answer a;
    a.result = result_of(j.at("result"));
    if (const json& forward = j.at("directions").at(0); !forward.is_null()) a.forward = result_of(forward);
    if (const json& backward = j.at("directions").at(1); !backward.is_null()) a.backward = result_of(backward);
    const json& seconds = j.at("seconds");
    a.prepare_seconds = seconds.at(0);
    a.solve_seconds = seconds.at(1);
    a.forward_seconds = seconds.at(2);
    a.backward_seconds = seconds.at(3);
    return a;
}

// --- the question, here or in the child -----------------------------------------------------------------------------------

struct Callbacks {
    std::function<void()> prepared = [] {};
    std::function<void(const Answer&)> closer = nullptr;
    std::function<void(const Answer&, std::int64_t peak_bytes)> answered = [](const Answer&, std::int64_t) {};
    std::function<void(const json&)> stepped;
};

void carry_out(const Question& question, const Callbacks& tell) {
    PeakMemory memory;
    const WallClock clock;
    const OpenSession open = question.prepare();
    const double seconds = clock.elapsed();
    memory.prepared();
    tell.prepared();
    memory.next_answer();
    const auto prepared = [&](Answer answer) {
        answer.prepare_seconds += seconds;
        return answer;
    };
    std::function<void(const Answer&)> closer;
    if (tell.closer) closer = [&](const Answer& so_far) { tell.closer(prepared(so_far)); };
    const Answer answer = prepared(ask(question.query, open, question.directions, closer));
    tell.answered(answer, memory.peak_bytes(answer.result.outside_bytes));
    for (const Question::Step& step : question.steps) tell.stepped(step.run(answer));
}

// Asks in the child. Sends an event, a line of JSON, after each step.
int tell(const Question& question, int events) {
    const auto send = [&](const json& event) {
        send_event(events, event.dump(-1, ' ', false, json::error_handler_t::replace));
    };
    const auto no_answer = attempt([&] {
        Callbacks tell;
        tell.prepared = [&] { send({{"event", "prepared"}}); };
        tell.closer = [&](const Answer& so_far) { send({{"event", "closer"}, {"answer", json_of(so_far)}}); };
        tell.answered = [&](const Answer& answer, std::int64_t peak_bytes) {
            send({{"event", "answer"}, {"answer", json_of(answer)}, {"peak", peak_bytes}});
        };
        tell.stepped = [&](const json& report) { send({{"event", "step"}, {"report", report}}); };
        carry_out(question, tell);
    });
    if (no_answer) send({{"event", "no answer"}, {"why", int(no_answer->why)}, {"reason", no_answer->reason}});
    return 0;
}

// --- in the process that waits ----------------------------------------------------------------------------------------

class Waiting {
public:
    Waiting(const Question& question, const AskLimits& limits, Child& child)
        : question_(question),
          limits_(limits),
          child_(child),
          listener_(child, std::numeric_limits<std::int64_t>::max(), HoldInterrupts::came) {}

    Answered run() {
        allow();
        std::string line;
        const auto waiting = [this] {
            if (limits_.waiting) limits_.waiting(doing(), so_far_ ? &*so_far_ : nullptr);
        };
        while (!ended()) {
            switch (listener_.hear(line, waiting)) {
                case Listener::Heard::event:
                    hear(line);
                    break;
                case Listener::Heard::late:
                    late();
                    break;
                case Listener::Heard::closed:
                    closed();
                    break;
                case Listener::Heard::interrupted:
                    throw InputError("interrupted");
                default:
                    fail({NoAnswer::Why::failed, "its process closed its pipe"});
            }
        }
        return std::move(all_);
    }

private:
    bool ended() const { return failed_ || (answered_ && all_.steps == question_.steps.size()); }

    const char* doing() const { return answered_ ? "writing and checking files" : prepared_ ? "solving" : "preparing"; }

    void allow() { listener_.allow(limits_.seconds + grace_of(limits_.seconds)); }

    // Records why nothing more follows. An answer that has arrived stays valid.
    void fail(NoAnswer why) {
        child_.kill();
        failed_ = true;
        if (answered_)
            all_.why_not_all = std::move(why.reason);
        else
            all_.no_answer = std::move(why);
    }

    // If the child has sent bounds, they become the answer. They may decide a yes/no question.
    void late() {
        const std::string missing = answered_   ? question_.steps[all_.steps].missing
                                    : prepared_ ? "it did not answer"
                                                : "it was not prepared";
        const std::string reason = fmt::format("killed: {} within the time limit of {:g} s and {:g} s of grace",
                                               missing, limits_.seconds, grace_of(limits_.seconds));
        if (!answered_ && so_far_) {
            all_.answer = std::move(*so_far_);
            Result& result = all_.answer.result;
            if (question_.query.is_question())
                result.status =
                    question_.query.answer(result.bounds.lower, result.bounds.upper).value_or(result.status);
            result.note = fmt::format("{}; these are its bounds after {:.3g} s", reason, all_.answer.solve_seconds);
            answered_ = true;
        }
        fail({NoAnswer::Why::timeout, reason});
    }

    void closed() {
        const std::string how = child_.how_it_ended();
        fail({child_.signal() ? NoAnswer::Why::signal : NoAnswer::Why::failed,
              fmt::format("its process ended with {} before it {}", how.empty() ? "exit code 0" : how,
                          answered_ ? "wrote every requested answer" : "answered")});
    }

    // Takes an event. Does not trust it, because a faulty solver may have written it.
    void hear(const std::string& line) {
        std::optional<NoAnswer> no_answer;
        try {
            const json event = json::parse(line);
            const std::string name = event.at("event");
            if (name == "no answer")
                no_answer = NoAnswer{why_of(event.at("why")), event.at("reason")};
            else
                take(name, event);
        } catch (const std::exception&) {
            no_answer = NoAnswer{NoAnswer::Why::failed, "its process wrote something other than an answer"};
        }
        if (!no_answer) return;
        if (no_answer->why == NoAnswer::Why::refused && !answered_) throw InputError(no_answer->reason);
        fail(std::move(*no_answer));
    }

    void take(const std::string& name, const json& event) {
        if (name == "closer") {
            Answer so_far = answer_of(event.at("answer"));
            const Bounds& bounds = so_far.result.bounds;
            if (may_bound_a_distance(bounds) && bounds.lower <= bounds.upper) so_far_ = std::move(so_far);
            return;
        }
        if (name == "prepared") {
            if (prepared_ || answered_) throw std::runtime_error("prepared a second time");
            prepared_ = true;
        } else if (name == "answer") {
            if (answered_) throw std::runtime_error("a second answer");
            all_.answer = answer_of(event.at("answer"));
            all_.peak_bytes = event.at("peak");
            answered_ = true;
        } else {
            if (name != "step" || !answered_) throw std::runtime_error("no such event");
            question_.steps.at(all_.steps).take(event.at("report"));
            ++all_.steps;
        }
        allow();
    }

    static NoAnswer::Why why_of(int number) {
        if (number < 0 || number > int(NoAnswer::Why::signal)) throw std::runtime_error("no such reason");
        return NoAnswer::Why(number);
    }

    const Question& question_;
    const AskLimits& limits_;
    Child& child_;
    Listener listener_;
    Answered all_;
    bool prepared_ = false, answered_ = false, failed_ = false;
    std::optional<Answer> so_far_;  // the last bounds that the child has sent before it answers
};

}  // namespace

Answered ask_here(const Question& question) {
    Answered all;
    Callbacks keep;
    keep.answered = [&](const Answer& answer, std::int64_t peak_bytes) {
        all.answer = answer;
        all.peak_bytes = peak_bytes;
    };
    keep.stepped = [&](const json& report) { question.steps[all.steps++].take(report); };
    carry_out(question, keep);
    return all;
}

Answered ask_in_child(const Question& question, const AskLimits& limits) {
    const HoldInterrupts hold;  // destroyed after the child and its folder, so that Ctrl-C leaves neither behind
    Launch launch;
    launch.scratch = "worker";
    launch.work = [&](int events) { return tell(question, events); };
    Child child(std::move(launch));
    Answered all = Waiting(question, limits, child).run();
    if (HoldInterrupts::came()) throw InputError("interrupted");
    return all;
}

}  // namespace hausbench
