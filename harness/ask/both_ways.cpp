#include "harness/ask/both_ways.h"

#include "algorithms/session/prepared_solver.h"
#include "algorithms/session/symmetric.h"

#include <algorithm>
#include <utility>

namespace hausbench {

Result turned(Result result) {
    std::swap(result.witness.source_point, result.witness.target_point);
    std::swap(result.witness.source_element, result.witness.target_element);
    result.witness.direction = Witness::Direction::target_to_source;
    for (Certificate& one : result.certificates) one.direction = Witness::Direction::target_to_source;
    return result;
}

Result larger_of(const Query& query, const Result& forward, const Result& backward) {
    for (const Result* one : {&forward, &backward}) {
        if (!may_bound_a_distance(one->bounds)) return *one;
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

BothWays ask_both_ways(const Query& query, const AskOneWay& ask, const std::function<void(const BothWays&)>& closer) {
    BothWays all;
    const auto take_forward = [&](const Result& forward) {
        all.forward = all.whole = forward;
        all.whole.bounds.upper = infinity;  // h(B,A) has no upper bound yet
    };
    take_forward(ask(false, [&](const Result& so_far) {
        take_forward(so_far);
        closer(all);
    }));
    if (all.forward->status == Status::above_cutoff) return all;
    const auto take_backward = [&](const Result& backward) {
        all.backward = turned(backward);
        all.whole = larger_of(query, *all.forward, *all.backward);
    };
    take_backward(ask(true, [&](const Result& so_far) {
        take_backward(so_far);
        closer(all);
    }));
    return all;
}

}  // namespace hausbench
