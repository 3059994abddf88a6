#include "commands/measurement_solve.h"

#include "check/certificate_file.h"
#include "error.h"
#include "process/child.h"
#include "process/interrupts.h"
#include "process/memory.h"
#include "record/json.h"
#include "result/field_file.h"
#include "session.h"
#include "shape_file.h"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>

namespace hausbench {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

// --- in the process that solves ---------------------------------------------------------------------------------------

// h(B,A), answered as h(A,B) of shapes in each other's place.
Result turned(Result result) {
    std::swap(result.witness.source_point, result.witness.target_point);
    std::swap(result.witness.source_element, result.witness.target_element);
    result.witness.direction = Witness::Direction::target_to_source;
    for (Certificate& one : result.certificates) one.direction = Witness::Direction::target_to_source;
    return result;
}

// H(A,B) from both directions. Where they are close enough, so is H: its gap is at most that of the direction with the larger upper
// bound, since its lower bound is at least that of this direction.
Result larger_of(const Query& query, const Result& forward, const Result& backward) {
    for (const Result* one : {&forward, &backward}) {
        if (!may_bound_a_distance(one->bounds)) return *one;
    }
    const bool above = backward.bounds.upper > forward.bounds.upper || std::isnan(backward.bounds.upper);
    Result whole = above ? backward : forward;
    const Result& lower = backward.bounds.lower > forward.bounds.lower ? backward : forward;
    whole.bounds.lower = lower.bounds.lower;
    whole.witness = lower.witness;
    whole.outside_bytes = std::max(forward.outside_bytes, backward.outside_bytes);
    whole.certificates.clear();
    if (!forward.certificates.empty() && !backward.certificates.empty()) {
        whole.certificates = forward.certificates;
        whole.certificates.insert(whole.certificates.end(), backward.certificates.begin(), backward.certificates.end());
    }
    if (const auto answer = query.answer(whole.bounds.lower, whole.bounds.upper)) {
        whole.status = *answer;
        whole.note.clear();
    }
    return whole;
}

class Solving {
public:
    Solving(const MeasureWork& work, PreparedPair shapes, Measured& measured)
        : work_(work), shapes_(std::move(shapes)), measured_(measured) {
        const MeasureRequest& request = work.request;
        query_.quantity = request.penetration ? Quantity::penetration : Quantity::directed;  // else from two of them
        query_.tolerance = work.tolerance;
        query_.threads = request.threads;
        query_.time_limit = request.time_limit;
        if (request.cutoff) query_.floor = query_.cutoff = *request.cutoff;
        forward_.emplace(session(shapes_.source, shapes_.target, false));
        if (!request.symmetric) return;
        if (relative()) both_.emplace(session(shapes_.source, shapes_.target, true));
        backward_.emplace(session(shapes_.target, shapes_.source, false));
    }

    // What is shared is counted once.
    double prepare_seconds() const {
        double sum = 0;
        for (const auto* one : {&forward_, &both_, &backward_}) {
            if (!*one) continue;
            for (const PreparationTime& time : (*one)->preparation())
                if (!time.shared) sum += time.seconds;
        }
        return sum;
    }

    void solve() {
        begin_ = Clock::now();
        if (!work_.request.symmetric) {
            measured_.result = ask(*forward_, query_, measured_.forward_seconds);
        } else if (relative()) {
            solve_relative();
        } else {
            solve_both();
        }
        measured_.solve_seconds = seconds_since(begin_);
    }

    void write_fields() {
        const PreparedShape& source = *shapes_.source;
        Fields fields = distance_fields(source, {}, *shapes_.target, {});
        if (work_.entry.info.fields) {  // once more, so that the time measured is that of the bounds alone
            Query query = query_;
            query.wanted.fields = true;
            Trace untraced;
            if (auto own = forward_->solve(query, untraced).fields)
                std::move(own->begin(), own->end(), std::back_inserter(fields));
        }
        export_fields(work_.request.fields, source.shape(), source.original(), fields);
    }

    // Once more too, with the bounds of the answer that it proves.
    void write_certificate() {
        Query query = query_;
        query.wanted.certificate = true;
        begin_ = Clock::now();
        double ignored = 0;
        Result result;
        if (!work_.request.symmetric) {
            result = ask(*forward_, query, ignored);
        } else if (relative()) {
            query.quantity = Quantity::symmetric;
            result = ask(*both_, query, ignored);
        } else {
            const Result forward = ask(*forward_, query, ignored);
            result = larger_of(query, forward, turned(ask(*backward_, query, ignored)));
        }
        if (result.certificates.empty()) return;
        const MeasureRequest& request = work_.request;
        const auto model = [](const std::filesystem::path& file, const PreparedShape& prepared) {
            Shape shape = prepared.shape();
            points_of(shape) = prepared.original();
            return CertificateFile::Model{file.string(), content_hash(shape), {}};
        };
        measured_.proven = 0;
        for (const Certificate& one : result.certificates) measured_.proven = std::max(*measured_.proven, one.proven);
        hausbench::write_certificate(
            request.certificate,
            {model(request.source, *shapes_.source), model(request.target, *shapes_.target),
             request.symmetric ? Quantity::symmetric : Quantity::directed, work_.entry.info.name, request.tolerance,
             measured_.tolerance_of, result.bounds, result.witness, std::move(result.certificates)});
    }

private:
    bool relative() const { return query_.tolerance.of == Tolerance::Of::lower; }

    Session session(const std::shared_ptr<PreparedShape>& a, const std::shared_ptr<PreparedShape>& b,
                    bool symmetric) const {
        QuerySet queries;
        queries.finest_tolerance = relative() ? 0 : query_.tolerance.value;
        queries.symmetric = symmetric;
        queries.threads = query_.threads;
        const SolverInfo& info = work_.entry.info;
        return {work_.entry, Options(info.name, info.parameters, work_.request.options), a, b, queries};
    }

    Result ask(const Session& session, Query query, double& seconds) const {
        const auto begin = Clock::now();
        query.time_limit = std::max(0.0, query.time_limit - seconds_since(begin_));
        Trace untraced;
        Result result = session.solve(query, untraced);
        result.note = one_line(result.note);
        seconds = seconds_since(begin);
        return result;
    }

    // Each direction to the full tolerance, without a floor: both are answers.
    void solve_both() {
        const Result forward = ask(*forward_, query_, measured_.forward_seconds);
        measured_.forward = forward;
        if (forward.status == Status::above_cutoff) {  // the question is answered; H has no bound from above
            measured_.result = forward;
            measured_.result.bounds.upper = infinity;
            return;
        }
        measured_.backward = turned(ask(*backward_, query_, measured_.backward_seconds));
        measured_.result = larger_of(query_, forward, *measured_.backward);
    }

    // A gap relative to the lower bound of a direction whose distance is 0 is never small enough. So H comes first, and each direction
    // then gets the gap that H may have.
    void solve_relative() {
        Query whole = query_;
        whole.quantity = Quantity::symmetric;
        double ignored = 0;
        measured_.result = ask(*both_, whole, ignored);
        const double gap = query_.tolerance.gap(measured_.result.bounds.lower);
        if (!(gap > 0) || measured_.result.status != Status::converged) return;
        Query query = query_;
        query.tolerance = {Tolerance::Of::absolute, gap};
        measured_.forward = ask(*forward_, query, measured_.forward_seconds);
        measured_.backward = turned(ask(*backward_, query, measured_.backward_seconds));
    }

    const MeasureWork& work_;
    PreparedPair shapes_;
    Measured& measured_;
    Query query_;
    Clock::time_point begin_;
    std::optional<Session> forward_, both_, backward_;
};

// --- between the two processes ----------------------------------------------------------------------------------------

json point_json(const Vec3& p) { return {number(p[0]), number(p[1]), number(p[2])}; }
Vec3 point_of(const json& j) { return {number(j.at(0)), number(j.at(1)), number(j.at(2))}; }

json result_json(const Result& r) {
    const Witness& w = r.witness;
    return {{"status", int(r.status)},
            {"bounds", {number(r.bounds.lower), number(r.bounds.upper)}},
            {"points", {point_json(w.source_point), point_json(w.target_point)}},
            {"elements", {w.source_element, w.target_element}},
            {"direction", int(w.direction)},
            {"note", r.note}};
}

Result result_of(const json& j) {
    Result r;
    const int status = j.at("status"), direction = j.at("direction");
    if (status < 0 || status > int(Status::stalled) || direction < 0 || direction > 1)
        throw std::runtime_error("no such status");
    r.status = Status(status);
    r.bounds = {number(j.at("bounds").at(0)), number(j.at("bounds").at(1))};
    r.witness = {point_of(j.at("points").at(0)), point_of(j.at("points").at(1)), j.at("elements").at(0),
                 j.at("elements").at(1), Witness::Direction(direction)};
    r.note = j.at("note");
    return r;
}

json answers_json(const Measured& m) {
    const auto optional = [](const std::optional<Result>& r) { return r ? result_json(*r) : json(); };
    return {{"event", "answer"},
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

enum class Trouble { input, memory, solver };

// Does the work and tells how it went, as one JSON object a line.
void tell(const MeasureWork& work, Shape source, Shape target, Measured& measured, int events) {
    const auto send = [&](const json& event) {
        const std::string line = event.dump(-1, ' ', false, json::error_handler_t::replace) + '\n';
        for (std::size_t done = 0; done < line.size();) {
            const ssize_t n = ::write(events, line.data() + done, line.size() - done);
            if (n <= 0) ::_exit(3);  // nobody listens
            done += std::size_t(n);
        }
    };
    const auto trouble = [&](Trouble kind, const std::string& what) {
        send({{"event", "trouble"}, {"kind", int(kind)}, {"what", one_line(what)}});
    };
    try {
        prepare_and_solve(
            work, std::move(source), std::move(target), measured,
            [&] {
                send({{"event", "prepared"}});
            },
            [&] { send(answers_json(measured)); });
        if (measured.proven) send({{"event", "certificate"}, {"proven", number(*measured.proven)}});
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

class Waiting {
public:
    Waiting(const MeasureWork& work, Child& child, Measured& measured)
        : limit_(work.request.time_limit), child_(child), measured_(measured) {
        allow("it was not prepared");
    }

    void run() {
        std::string line;
        while (!ended_) {
            if (HoldInterrupts::came()) return;
            switch (child_.listen(std::chrono::milliseconds(20), line)) {
                case Child::Heard::nothing:
                    if (Clock::now() > deadline_) return late();
                    break;
                case Child::Heard::closed:
                    return closed();
                case Child::Heard::line:
                    hear(line);
            }
        }
    }

private:
    void allow(const char* phase) {
        phase_ = phase;
        const double seconds = std::min(limit_ + grace_of(limit_), 1e9);  // a clock does not hold infinity
        deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    }

    void fail(RowStatus status, const std::string& reason) {
        child_.kill();
        measured_.failed = NoAnswer{status, reason};
        ended_ = true;
    }

    void late() {
        fail(RowStatus::timeout, fmt::format("killed: {} within the time limit of {:g} s and {:g} s of grace", phase_,
                                             limit_, grace_of(limit_)));
    }

    void closed() {
        if (!child_.ended_within(std::chrono::seconds(1)))
            return fail(RowStatus::failed, "its process closed its pipe");
        const std::string how = child_.how_it_ended();
        fail(child_.signal() ? RowStatus::signal : RowStatus::failed,
             fmt::format("its process ended with {} before it answered", how.empty() ? "exit code 0" : how));
    }

    // A solver may have written it: nothing in it is taken for granted.
    void hear(const std::string& line) {
        Trouble kind{};
        std::string what;
        try {
            const json event = json::parse(line);
            const std::string name = event.at("event");
            if (name == "prepared") return allow("it did not answer");
            if (name == "answer") {
                take_answers(event, measured_);
                return allow("its fields or its certificate were not written");
            }
            if (name == "certificate") {
                measured_.proven = number(event.at("proven"));
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
            return fail(RowStatus::failed, "its process wrote something that is no answer");
        }
        if (kind == Trouble::input) throw InputError(what);
        fail(kind == Trouble::memory ? RowStatus::out_of_memory : RowStatus::failed,
             kind == Trouble::memory ? "it was refused memory that it asked for" : what);
    }

    double limit_;
    Child& child_;
    Measured& measured_;
    const char* phase_ = "";
    Clock::time_point deadline_;
    bool ended_ = false;
};

}  // namespace

double grace_of(double time_limit) { return std::max(1.0, 0.1 * time_limit); }

void prepare_and_solve(const MeasureWork& work, Shape source, Shape target, Measured& measured,
                       const std::function<void()>& prepared, const std::function<void()>& answered) {
    PeakMemory memory;
    Solving solving(work, prepare_pair(work.entry.info, std::move(source), std::move(target)), measured);
    memory.prepared();
    measured.prepare_seconds = solving.prepare_seconds();
    prepared();
    memory.next_answer();
    solving.solve();
    measured.peak_bytes = memory.peak_bytes(measured.result.outside_bytes);
    answered();
    if (!work.request.fields.empty()) solving.write_fields();
    if (!work.request.certificate.empty()) solving.write_certificate();
}

void solve_outside(const MeasureWork& work, Shape source, Shape target, Measured& measured) {
    const HoldInterrupts hold;  // destroyed after the process and its folder
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
