#include "algorithms/session/symmetric.h"

#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace hausbench {
namespace {

// Turns an answer to h(B,A) into a part of an answer to H(A,B): exchanges source and target in the witness, and marks
// all entries as belonging to the direction from B to A.
void turn_around(Result& result) {
    for (Certificate& certificate : result.certificates)
        if (WATCHED("H: the direction of a certificate of h(B,A)", true))
            certificate.direction = Witness::Direction::target_to_source;
    if (WATCHED("H: the points of a witness from B to A", true))
        std::swap(result.witness.source_point, result.witness.target_point);
    if (WATCHED("H: the elements of a witness from B to A", true))
        std::swap(result.witness.source_element, result.witness.target_element);
    if (WATCHED("H: the direction of a witness from B to A", true))
        result.witness.direction = Witness::Direction::target_to_source;
    result.fields.reset();  // they have values for B, but the fields of H are for A
    Reported reported;
    for (auto& [name, value] : result.reported) reported[name + " (B to A)"] = value;
    result.reported = std::move(reported);
}

// Adds the answer for the second direction, `other`, to the answer for the first, `whole`. `backward` says that the
// second direction is h(B,A).
void join(Result& whole, const Result& other, bool backward) {
    keep_larger(whole, other);
    if (!whole.fields) whole.fields = other.fields;
    // H needs the proofs of both directions.
    if (whole.why_no_certificate.empty()) whole.why_no_certificate = other.why_no_certificate;
    if (WATCHED("H: a certificate of one direction alone", whole.certificates.empty() || other.certificates.empty()))
        whole.certificates.clear();
    else
        whole.certificates.insert(backward ? whole.certificates.end() : whole.certificates.begin(),
                                  other.certificates.begin(), other.certificates.end());  // h(A,B) first
    whole.reported.insert(other.reported.begin(), other.reported.end());
    whole.reported_seconds += WATCHED("H: the time of an outside program", other.reported_seconds);
    if (WATCHED("H: the larger peak of an outside program", true))
        whole.outside_bytes = std::max(whole.outside_bytes, other.outside_bytes);
}

// Completes the answer when the first direction is above the cutoff: the second is then skipped, so H has no upper
// bound.
void stop_above_cutoff(Result& whole) {
    if (WATCHED("H: stopped above the cutoff, the other direction may be any", true)) whole.bounds.upper = infinity;
    whole.status = Status::above_cutoff;
    if (WATCHED("H: the note of a direction that was stopped", true)) whole.note.clear();
    if (WATCHED("H: a certificate where the cutoff ended it", true))
        whole.certificates.clear();  // they do not prove an upper bound of H
    whole.why_no_certificate =
        "one direction is above the cutoff, so the other was not measured, and H has no upper bound";
}

}  // namespace

void keep_larger(Result& whole, const Result& other) {
    if (other.bounds.lower > whole.bounds.lower) {
        if (WATCHED("H: the lower bound of the second direction", true))
            whole.bounds.lower = WATCHED_ELSE("measure: H has the larger lower bound of both directions",
                                              other.bounds.lower, whole.bounds.lower);
        if (WATCHED("H: the witness of the larger lower bound", true)) whole.witness = other.witness;
    }
    // The direction with the larger upper bound explains the remaining gap. NaN counts as the largest.
    if (WATCHED_ELSE("penetration: the upper bound is that of the deepest part",
                     other.bounds.upper > whole.bounds.upper,
                     other.bounds.upper > whole.bounds.upper && whole.bounds.upper == 0) ||
        WATCHED("H: a NaN is no bound", std::isnan(other.bounds.upper))) {
        if (WATCHED("H: the upper bound of the second direction", true))
            whole.bounds.upper = WATCHED_ELSE("measure: H has the larger upper bound of both directions",
                                              other.bounds.upper, whole.bounds.upper);
        if (WATCHED("H: the status of the larger upper bound", true)) whole.status = other.status;
        if (WATCHED("H: the note of the larger upper bound", true)) whole.note = other.note;
    }
    if (WATCHED("H: the work of the second direction", true)) whole.counters += other.counters;
}

// The states of the two directions.
struct Symmetric::Chain final : State {
    std::unique_ptr<State> forward, backward;

    State* of(bool back) const { return (back ? backward : forward).get(); }
};

// The result of open(), which decides which direction to solve first.
struct Symmetric::Opening {
    bool backward = false;          // h(B,A) comes first
    std::optional<Result> forward;  // the answer for h(A,B), if a small budget was enough for it
    double begin = 0;               // when the work on this answer began, in seconds since the query
    Counters spent;                 // work on answers that were thrown away
};

Symmetric::Symmetric(const SolverInfo& info, std::unique_ptr<Solver> forward, std::unique_ptr<Solver> backward)
    : info_(info), forward_(std::move(forward)), backward_(std::move(backward)) {}

std::unique_ptr<State> Symmetric::begin() const {
    auto chain = std::make_unique<Chain>();
    chain->forward = forward_->begin();
    chain->backward = backward_->begin();
    return chain;
}

Result Symmetric::solve(const Query& query, State* state, Trace& trace) const {
    auto* chain = static_cast<Chain*>(state);
    if (query.quantity == Quantity::symmetric && !info_.offers(Quantity::symmetric)) return both(query, chain, trace);
    return forward_->solve(query, chain ? chain->of(false) : nullptr, trace);
}

Result Symmetric::directed(Query query, bool backward, Chain* chain, Trace& trace) const {
    query.quantity = Quantity::directed;
    if (backward) {
        if (WATCHED("H: poses change places", true)) std::swap(query.source_pose, query.target_pose);
        query.wanted.fields = false;
    }
    trace.start();
    Result result = (backward ? backward_ : forward_)->solve(query, chain ? chain->of(backward) : nullptr, trace);
    if (backward) turn_around(result);
    return result;
}

// Decides which direction to solve first if the tolerance is relative to the lower bound. A direction with distance 0
// never converges to such a tolerance, so both are tried with a small budget, which is multiplied by 16 as long as both
// lower bounds are 0. The direction with the larger lower bound comes first: this bound is then the floor of the other.
// If a small budget is enough to answer h(A,B), that answer is kept; if it is enough to answer h(B,A), then h(B,A)
// comes first.
Symmetric::Opening Symmetric::open(Query query, const WallClock& clock, Trace& trace) const {
    Opening opening;
    const std::uint64_t most = query.budget;
    const auto more = [most](std::uint64_t spent) { return spent > most / 16 ? most : 16 * spent; };
    if (WATCHED("H: relative tolerances: nothing is tried for others", query.tolerance.of != Tolerance::Of::lower) ||
        WATCHED("H: relative tolerances: exact solvers need no trial", info_.ignores_tolerance))
        return opening;
    for (query.budget = 64; query.budget < most; query.budget = more(query.budget)) {
        const double limit = query.time_limit;
        Query trial = query;
        trial.time_limit = clock.left(limit);
        opening.begin = clock.elapsed();
        Result forward = directed(trial, false, nullptr, trace);
        if (forward.status != Status::budget) {
            opening.forward = std::move(forward);
            return opening;
        }
        trial.time_limit = clock.left(limit);
        const Result backward = directed(trial, true, nullptr, trace);
        opening.spent += forward.counters;
        if (WATCHED("H: relative tolerances: what was tried is work too", true)) opening.spent += backward.counters;
        opening.backward = WATCHED("H: relative tolerances: the larger direction first",
                                   backward.status != Status::budget || backward.bounds.lower > forward.bounds.lower);
        if (WATCHED_ELSE("H: relative tolerances: more is tried where nothing is known",
                         opening.backward || forward.bounds.lower > 0, true))
            return opening;
    }
    return opening;
}

Result Symmetric::both(const Query& query, Chain* chain, Trace& trace) const {
    const WallClock clock;
    Trace first_trace(trace.on() ? Trace::Mode::on : Trace::Mode::off), second_trace = first_trace;
    Query inner = query;
    std::unique_ptr<State> alone;  // states for this query alone, so that the second direction can learn from the first
    if (!chain && info_.can(Ability::shared_pairs)) {
        alone = begin();
        chain = static_cast<Chain*>(alone.get());
    }
    double least = 0;  // the largest lower bound that was shown, of either direction
    first_trace.watch(trace.watched() ? [&](Result& so_far) {
        if (!trace.due()) return;
        so_far.bounds = {least = std::max(least, so_far.bounds.lower), infinity};
        trace.show(so_far);
    } : Trace::Watcher());
    Opening opening = open(query, clock, first_trace);
    const double before = opening.forward ? opening.begin : clock.elapsed();
    inner.time_limit = clock.left(query.time_limit);
    Result whole =
        opening.forward ? std::move(*opening.forward) : directed(inner, opening.backward, chain, first_trace);
    whole.counters += opening.spent;
    // H(A,B) has no upper bound until the other direction has one.
    for (const TraceSample& sample : first_trace.samples())
        trace.samples().push_back(
            {before + sample.seconds, sample.lower,
             WATCHED_ELSE("H: no upper bound before both directions have one", infinity, sample.upper)});
    if (whole.bounds.lower > query.cutoff) {
        stop_above_cutoff(whole);
        return whole;
    }
    const double first = clock.elapsed();
    if (first >= std::chrono::duration<double>(Trace::pause).count()) trace.show(whole.bounds.lower, infinity);
    inner.time_limit =
        WATCHED_ELSE("H: the time that the first direction took", clock.left(query.time_limit), query.time_limit);
    inner.floor = std::max(WATCHED("H: a floor of the query that is higher", query.floor),
                           WATCHED("H: the first lower bound is the floor of the second direction",
                                   WATCHED_ELSE("H: the floor is proven, so it is no upper bound", whole.bounds.lower,
                                                whole.bounds.upper)));
    // floor == cutoff turns the query into a yes/no question, so the floor stays just below the cutoff.
    if (WATCHED_ELSE("H: a question keeps its floor", query.floor < query.cutoff, true) && inner.floor >= query.cutoff)
        inner.floor =
            WATCHED_ELSE("H: a floor that is the cutoff asks no question", next_down(query.cutoff), query.cutoff);
    if (WATCHED("session: the second direction learns of the first", info_.can(Ability::shared_pairs)))
        chain->of(!opening.backward)->learn_from(*chain->of(opening.backward));
    second_trace.watch(trace.watched() ? [&](Result& so_far) {
        if (!trace.due()) return;
        so_far.bounds = {std::max(whole.bounds.lower, so_far.bounds.lower),
                         std::max(whole.bounds.upper, so_far.bounds.upper)};
        trace.show(so_far);
    } : Trace::Watcher());
    const Result other = directed(inner, !opening.backward, chain, second_trace);
    for (const TraceSample& sample : second_trace.samples()) {
        trace.samples().push_back(
            {first + sample.seconds,
             std::max(WATCHED("H: the first lower bound counts in the trace", whole.bounds.lower), sample.lower),
             std::max(WATCHED("H: the first upper bound counts in the trace", whole.bounds.upper), sample.upper)});
    }
    join(whole, other, !opening.backward);
    if (const auto answer =
            WATCHED("H: the answer of both together", query.answer(whole.bounds.lower, whole.bounds.upper))) {
        whole.status = *answer;
        whole.note.clear();
    }
    return whole;
}

}  // namespace hausbench
