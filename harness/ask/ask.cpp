#include "harness/ask/ask.h"

#include "algorithms/error.h"
#include "algorithms/kernel/parallel.h"
#include "algorithms/session/adapter.h"
#include "algorithms/session/session.h"
#include "algorithms/session/symmetric.h"

#include <algorithm>
#include <utility>

namespace hausbench {

namespace {

// Takes the answer for h(B,A), for which a solver has the shapes swapped. Swaps the ends of the witness back, so that
// its source point is on A again, and marks the direction.
Result turned(Result result) {
    std::swap(result.witness.source_point, result.witness.target_point);
    std::swap(result.witness.source_element, result.witness.target_element);
    result.witness.direction = Witness::Direction::target_to_source;
    for (Certificate& certificate : result.certificates) certificate.direction = Witness::Direction::target_to_source;
    return result;
}

// Combines both directions into H(A,B). If both gaps are within the tolerance, so is the gap of H. The upper bound of H
// is the larger of the two upper bounds. The lower bound of H is at least the lower bound of the direction that has
// this upper bound, so the gap of H is at most the gap of that direction.
Result larger_of(const Query& query, const Result& forward, const Result& backward) {
    for (const Result* result : {&forward, &backward}) {
        if (!may_bound_a_distance(result->bounds)) return *result;
    }
    Result whole = forward;
    keep_larger(whole, backward);
    whole.outside_bytes = std::max(forward.outside_bytes, backward.outside_bytes);
    whole.certificates.clear();
    whole.why_no_certificate =
        forward.why_no_certificate.empty() ? backward.why_no_certificate : forward.why_no_certificate;
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

Result nothing_in_time() {
    Result result;
    result.bounds = {0, infinity};
    result.status = Status::time_limit;
    return result;
}

class Asking {
public:
    Asking(const OpenSession& open, const std::function<void(const Answer&)>& closer) : open_(open), closer_(closer) {}

    Answer ask(const Query& query, Directions directions) {
        if (query.quantity != Quantity::symmetric)
            solve_whole(query);
        else if (query.tolerance.of == Tolerance::Of::lower)
            solve_relative(query, directions);
        else
            solve_both(query);
        return std::move(answer_);
    }

private:
    using Keep = std::function<void(const Result&)>;  // stores an answer, or bounds on the way, in answer_

    void solve_whole(const Query& query) {
        double whole = 0;  // the same as answer_.solve_seconds
        const auto keep = [this](const Result& result) { answer_.result = result; };
        solve(query, false, whole, keep);
    }

    void solve_relative(const Query& query, Directions directions) {
        solve_whole(query);
        const Result& whole = answer_.result;
        const double gap = query.tolerance.gap(whole.bounds.lower);
        if (directions == Directions::unknown || !(gap > 0) || whole.status != Status::converged) return;
        show_so_far();
        Query directed = query;
        directed.quantity = Quantity::directed;
        directed.tolerance = {Tolerance::Of::absolute, gap};
        solve(directed, false, answer_.forward_seconds, [this](const Result& result) { answer_.forward = result; });
        solve(directed, true, answer_.backward_seconds,
              [this](const Result& result) { answer_.backward = turned(result); });
    }

    void solve_both(const Query& query) {
        Query directed = query;
        directed.quantity = Quantity::directed;
        solve(directed, false, answer_.forward_seconds, [this](const Result& forward) {
            answer_.forward = answer_.result = forward;
            answer_.result.bounds.upper = infinity;  // h(B,A) has no upper bound yet
        });
        if (answer_.forward->status == Status::above_cutoff && !query.wanted.certificate) return;
        show_so_far();
        solve(directed, true, answer_.backward_seconds, [&](const Result& backward) {
            answer_.backward = turned(backward);
            answer_.result = larger_of(query, *answer_.forward, *answer_.backward);
        });
    }

    // Shows what is known between two directions: it holds even if the next is never answered.
    void show_so_far() const {
        if (!closer_) return;
        Answer so_far = answer_;
        so_far.result.status = Status::time_limit;
        closer_(so_far);
    }

    void solve(Query query, bool backward, double& seconds, const Keep& keep) {
        if (backward) std::swap(query.source_pose, query.target_pose);
        try {
            const Opened opened = open(query, backward);
            const WallClock clock;
            const double before = answer_.solve_seconds;
            const auto stop = [&] { answer_.solve_seconds = before + (seconds = clock.elapsed()); };
            query.time_limit = std::max(0.0, query.time_limit - before);
            Trace trace;
            if (closer_) {
                trace.watch([&](const Result& so_far) {
                    keep(so_far);
                    stop();
                    closer_(answer_);
                });
            }
            Result result = opened.session->solve(query, opened.state, trace);
            stop();
            result.note = one_line(result.note);
            keep(result);
        } catch (const BuildingStopped&) {
            keep(nothing_in_time());
        }
    }

    Opened open(const Query& query, bool backward) {
        const WallClock clock;
        const auto stop = [&] { answer_.prepare_seconds += clock.elapsed(); };
        try {
            const Stoppable stoppable(query.interrupt);
            Opened opened = open_(query, backward);
            stop();
            return opened;
        } catch (const BuildingStopped&) {
            stop();
            throw;
        }
    }

    const OpenSession& open_;
    const std::function<void(const Answer&)>& closer_;
    Answer answer_;
};

}  // namespace

Answer ask(const Query& query, const OpenSession& open, Directions directions,
           const std::function<void(const Answer&)>& closer) {
    return Asking(open, closer).ask(query, directions);
}

}  // namespace hausbench
