#include "algorithms/session/session_parts.h"

#include "algorithms/kernel/rounding.h"

#include <cmath>

namespace hausbench {

// One direction of H(A,B), in scaled units; its witness names points of A and of B as that of H does.
Result Session::one_of_both(Query query, bool backward, Chain* chain, Trace& trace) const {
    query.quantity = Quantity::directed;
    if (backward) std::swap(query.source_pose, query.target_pose);
    if (backward) query.wanted.fields = false;  // they would be of B
    trace.start();
    Result result = directed(query, backward, chain, trace);
    if (!backward) return result;
    for (Certificate& one : result.certificates) one.direction = Witness::Direction::target_to_source;
    std::swap(result.witness.source_point, result.witness.target_point);
    std::swap(result.witness.source_element, result.witness.target_element);
    result.witness.direction = Witness::Direction::target_to_source;
    result.fields.reset();
    Reported reported;
    for (auto& [name, value] : result.reported) reported[name + " (B to A)"] = value;
    result.reported = std::move(reported);
    return result;
}

// A gap relative to the lower bound is never small enough where that bound is 0, as that of h(A,B) is where A is a part of B. So
// where the tolerance is of that kind, a little work on both directions says which one seems to be the larger: that one comes
// first, and its lower bound is the floor of the other. An answer that takes little work is kept.
Session::Opening Session::open(Query query, const Clock& clock, Trace& trace) const {
    Opening opening;
    const std::uint64_t most = query.budget;
    const auto more = [most](std::uint64_t spent) { return spent > most / 16 ? most : 16 * spent; };
    if (query.tolerance.of != Tolerance::Of::lower || entry_.info.ignores_tolerance) return opening;
    for (query.budget = 64; query.budget < most; query.budget = more(query.budget)) {
        const double limit = query.time_limit;
        Query asked = query;
        asked.time_limit = clock.left(limit);
        opening.begin = clock.elapsed();
        Result forward = one_of_both(asked, false, nullptr, trace);
        if (forward.status != Status::budget) {
            opening.forward = std::move(forward);
            return opening;
        }
        asked.time_limit = clock.left(limit);
        const Result backward = one_of_both(asked, true, nullptr, trace);
        opening.spent += forward.counters;
        opening.spent += backward.counters;
        opening.backward = backward.status != Status::budget || backward.bounds.lower > forward.bounds.lower;
        if (opening.backward || forward.bounds.lower > 0) return opening;
    }
    return opening;
}

void keep_larger(Result& whole, const Result& other) {
    if (other.bounds.lower > whole.bounds.lower) {
        whole.bounds.lower = other.bounds.lower;
        whole.witness = other.witness;
    }
    // Where the bounds are still apart, it is the one with the larger upper bound that keeps them apart, and says why. A NaN is no bound at all.
    if (other.bounds.upper > whole.bounds.upper || std::isnan(other.bounds.upper)) {
        whole.bounds.upper = other.bounds.upper;
        whole.status = other.status;
        whole.note = other.note;
    }
    whole.counters += other.counters;
}

// Adds what is known of the other direction; `backward`: that is h(B,A).
void Session::join(Result& whole, const Result& other, bool backward) {
    keep_larger(whole, other);
    if (!whole.fields) whole.fields = other.fields;
    // The proof of one direction alone proves nothing of H.
    if (whole.why_no_certificate.empty()) whole.why_no_certificate = other.why_no_certificate;
    if (whole.certificates.empty() || other.certificates.empty())
        whole.certificates.clear();
    else
        whole.certificates.insert(backward ? whole.certificates.end() : whole.certificates.begin(),
                                  other.certificates.begin(), other.certificates.end());  // that of h(A,B) first
    whole.reported.insert(other.reported.begin(), other.reported.end());
    whole.reported_seconds += other.reported_seconds;
    whole.outside_bytes = std::max(whole.outside_bytes, other.outside_bytes);
}

// H(A,B) = max(h(A,B), h(B,A)), in scaled units.
Result Session::symmetric(const Query& query, Chain* chain, Trace& trace) const {
    const Clock clock;
    Trace one(trace.on() ? Trace::Mode::on : Trace::Mode::off), two = one;
    Query asked = query;
    Chain alone;  // of this query
    if (!chain && entry_.info.shares_pairs) chain = &alone;
    Opening opening = open(query, clock, one);
    const double before = opening.forward ? opening.begin : clock.elapsed();
    asked.time_limit = clock.left(query.time_limit);
    Result whole = opening.forward ? std::move(*opening.forward) : one_of_both(asked, opening.backward, chain, one);
    whole.counters += opening.spent;
    // Until the other direction has a bound, H(A,B) has none from above.
    for (const TraceSample& sample : one.samples())
        trace.samples().push_back({before + sample.seconds, sample.lower, infinity});
    if (whole.bounds.lower > query.cutoff) {
        whole.bounds.upper = infinity;
        whole.status = Status::above_cutoff;
        whole.note.clear();
        whole.certificates.clear();  // what they prove is not the bound of H
        whole.why_no_certificate =
            "one direction is above the cutoff, so the other one was not measured and H has no upper bound";
        return whole;
    }
    const double first = clock.elapsed();
    asked.time_limit = clock.left(query.time_limit);
    asked.floor = std::max(query.floor, whole.bounds.lower);
    // A floor that is the cutoff would ask a question that nobody asked.
    if (query.floor < query.cutoff && asked.floor >= query.cutoff) asked.floor = next_down(query.cutoff);
    struct Forget {  // also where the solver throws
        Chain* chain;
        ~Forget() {
            if (chain) chain->opposite = nullptr;
        }
    } const forget{chain};
    if (chain && entry_.info.shares_pairs) chain->opposite = chain->states[opening.backward ? 1 : 0].get();
    const Result other = one_of_both(asked, !opening.backward, chain, two);
    for (const TraceSample& sample : two.samples()) {
        trace.samples().push_back({first + sample.seconds, std::max(whole.bounds.lower, sample.lower),
                                   std::max(whole.bounds.upper, sample.upper)});
    }
    join(whole, other, !opening.backward);
    if (const auto answer = query.answer(whole.bounds.lower, whole.bounds.upper)) {
        whole.status = *answer;
        whole.note.clear();
    }
    return whole;
}

}  // namespace hausbench
