#include "harness/commands/measurement_solve.h"

#include "algorithms/error.h"
#include "algorithms/session/adapter.h"
#include "algorithms/session/session.h"
#include "datasets/shape_file.h"
#include "harness/ask/both_ways.h"
#include "harness/check/certificate_file.h"
#include "harness/result/field_file.h"
#include "process/memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace hausbench {

namespace {

class Solving {
public:
    Solving(const MeasureWork& work, PreparedPair shapes, Measured& measured, const MeasureSteps& steps)
        : work_(work), shapes_(std::move(shapes)), measured_(measured), steps_(steps) {
        const MeasureRequest& request = work.request;
        // A symmetric query is answered by two directed ones.
        query_.quantity = request.asks_for_h() ? Quantity::directed : request.quantity();
        query_.statistics = asked_statistics(request, measured.source.counted_by, measured.target.counted_by);
        query_.weigh = request.weigh;
        query_.share_tolerance = request.share_tolerance;
        query_.tolerance = work.tolerance;
        query_.threads = request.threads;
        query_.time_limit = request.time_limit;
        query_.budget = request.budget;
        if (measured.cutoff) query_.floor = query_.cutoff = *measured.cutoff;
        forward_.emplace(session(shapes_.source, shapes_.target, false));
        if (!request.asks_for_h()) return;
        if (relative()) both_.emplace(session(shapes_.source, shapes_.target, true));
        backward_.emplace(session(shapes_.target, shapes_.source, false));
    }

    // Returns the total preparation time. Structures shared between sessions count once.
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
        clock_ = {};
        if (!work_.request.asks_for_h()) {
            measured_.result = ask(*forward_, query_, measured_.forward_seconds,
                                   [&](const Result& so_far) { measured_.result = so_far; });
        } else if (relative()) {
            solve_relative();
        } else {
            solve_both();
        }
        measured_.solve_seconds = clock_.elapsed();
    }

    void write_fields(const std::function<void()>& drawn) {
        const auto& file = work_.request.fields;
        const bool alone = !work_.request.asks_for_h();
        const Result there = alone ? measured_.result : of_direction(measured_.forward);
        write_fields(*forward_, *shapes_.source, *shapes_.target, there, there.witness.source_point,
                     there.witness.source_element, file);
        drawn();
        if (!work_.request.asks_for_h()) return;
        const Result back = of_direction(measured_.backward);
        write_fields(*backward_, *shapes_.target, *shapes_.source, back, back.witness.target_point,
                     back.witness.target_element, file_of_way_back(file));
        drawn();
    }

    // Solves once more, writes a certificate with the bounds of the new answer, and checks it.
    void write_certificate(const std::function<void()>& written) {
        Query query = query_;
        query.wanted.certificate = true;
        clock_ = {};
        double ignored = 0;
        Result result;
        if (!work_.request.asks_for_h()) {
            result = ask(*forward_, query, ignored);
        } else if (relative()) {
            query.quantity = Quantity::symmetric;
            result = ask(*both_, query, ignored);
        } else {
            const Result forward = ask(*forward_, query, ignored);
            result = larger_of(query, forward, turned(ask(*backward_, query, ignored)));
        }
        if (result.certificates.empty()) {
            measured_.why_not_proven = result.why_no_certificate;
            return;
        }
        const MeasureRequest& request = work_.request;
        const Shape source = as_loaded(*shapes_.source), target = as_loaded(*shapes_.target);
        CertificateFile content{{request.source.string(), content_hash(source), {}},
                                {request.target.string(), content_hash(target), {}},
                                request.symmetric ? Quantity::symmetric : Quantity::directed,
                                work_.entry.info.name,
                                request.tolerance,
                                measured_.tolerance_of,
                                result.bounds,
                                result.witness,
                                std::move(result.certificates)};
        state_what_is_proven(content, source, target);
        hausbench::write_certificate(request.certificate, content);
        double proven = 0;
        for (const Certificate& one : content.certificates) proven = std::max(proven, one.proven);
        measured_.proven = proven;
        written();
        const CertificateVerdict verdict = verify_certificate(content, source, target);
        if (!verdict.accepted) measured_.doubt = "its own check refuses this proof: " + verdict.refusal;
    }

private:
    // Returns the answer for a direction. If it was not solved separately, returns the bounds that follow from H: 0 and
    // the upper bound of H.
    Result of_direction(const std::optional<Result>& answer) const {
        Result result;
        result.bounds.upper = measured_.result.bounds.upper;
        return answer.value_or(result);
    }

    // Writes the shape `from` with its distances to `to`. `witness` is the point of `from` farthest from `to`, if
    // known, and becomes a vertex.
    void write_fields(const Session& session, const PreparedShape& from, const PreparedShape& to, const Result& answer,
                      const Vec3& witness, Index witness_element, const std::filesystem::path& file) {
        const Drawing drawing{work_.request.resolution, answer.bounds.lower, witness, witness_element};
        const DrawnField drawn = draw_distance(from, {}, to, {}, drawing);
        Fields own;
        // Solves again for the solver's own fields, so that the measured time is the time for the bounds alone.
        if (work_.entry.info.can(Ability::fields)) {
            Query query = query_;
            query.wanted.fields = true;
            const double gap = query.tolerance.gap(measured_.result.bounds.lower);
            if (relative() && gap > 0) query.tolerance = {Tolerance::Of::absolute, gap};
            Trace untraced;
            if (auto fields = session.solve(query, untraced).fields) own = std::move(*fields);
        }
        export_fields(file, drawn, own);
        measured_.drawn.push_back({file, answer.bounds, drawn.largest(), std::int64_t(drawn.vertices.rows()),
                                   std::int64_t(drawn.pieces.rows()), drawn.resolved});
    }

    bool relative() const { return query_.tolerance.of == Tolerance::Of::lower; }

    Session session(const std::shared_ptr<PreparedShape>& a, const std::shared_ptr<PreparedShape>& b,
                    bool symmetric) const {
        QuerySet queries;
        queries.finest_tolerance = relative() ? 0 : query_.tolerance.value;
        queries.symmetric = symmetric;
        queries.threads = query_.threads;
        queries.both_ways = std::any_of(query_.statistics.begin(), query_.statistics.end(), needs_target);
        const SolverInfo& info = work_.entry.info;
        return {work_.entry, Options(info.name, info.parameters, work_.request.options), PreparedPair{a, b}, queries};
    }

    // `keep` stores an answer so far in `measured_`.
    Result ask(const Session& session, Query query, double& seconds,
               const std::function<void(const Result&)>& keep = nullptr) const {
        const WallClock clock;
        query.time_limit = clock_.left(query.time_limit);
        Trace trace;
        if (keep) {
            trace.watch([&](Result& so_far) {
                keep(so_far);
                seconds = clock.elapsed();
                measured_.solve_seconds = clock_.elapsed();
                steps_.closer();
            });
        }
        Result result = session.solve(query, trace);
        result.note = one_line(result.note);
        seconds = clock.elapsed();
        return result;
    }

    // Solves each direction to the full tolerance, because both are printed. (For H alone, the second direction could
    // stop once it is known to be below the first.)
    void solve_both() {
        const auto keep = [&](const BothWays& so_far) {
            measured_.result = so_far.whole;
            measured_.forward = so_far.forward;
            measured_.backward = so_far.backward;
        };
        const auto ask_one = [&](bool backward, const std::function<void(const Result&)>& closer) {
            return ask(backward ? *backward_ : *forward_, query_,
                       backward ? measured_.backward_seconds : measured_.forward_seconds, closer);
        };
        keep(ask_both_ways(query_, ask_one, keep));
    }

    // Solves with a tolerance that is a fraction of the lower bound. A direction with distance 0 has the lower bound 0,
    // so its allowed gap would be 0. So H is solved first, and the gap allowed for H becomes the absolute tolerance of
    // both directions.
    void solve_relative() {
        Query whole = query_;
        whole.quantity = Quantity::symmetric;
        double ignored = 0;
        measured_.result = ask(*both_, whole, ignored, [&](const Result& so_far) { measured_.result = so_far; });
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
    const MeasureSteps& steps_;
    Query query_;
    WallClock clock_;                                   // since the questions began, which share the time limit
    std::optional<Session> forward_, both_, backward_;  // for h(A,B), H(A,B), h(B,A), as far as needed
};

}  // namespace

void prepare_and_solve(const MeasureWork& work, Shape source, Shape target, Measured& measured,
                       const MeasureSteps& steps) {
    PeakMemory memory;
    Solving solving(work, prepare_pair(work.entry.info, std::move(source), std::move(target)), measured, steps);
    memory.prepared();
    measured.prepare_seconds = solving.prepare_seconds();
    steps.prepared();
    memory.next_answer();
    solving.solve();
    measured.peak_bytes = memory.peak_bytes(measured.result.outside_bytes);
    steps.answered();
    if (!work.request.fields.empty()) solving.write_fields(steps.drawn);
    if (!work.request.certificate.empty()) solving.write_certificate(steps.proved);
}

}  // namespace hausbench
