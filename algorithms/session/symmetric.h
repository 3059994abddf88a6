// Emulates H(A,B) = max(h(A,B), h(B,A)) for solvers that answer only directed queries.
#pragma once

#include "algorithms/session/adapter.h"

namespace hausbench {

// Answers a query for H(A,B) by a query for h(A,B) and a second one for h(B,A). The lower bound of the first answer is
// the floor of the second query: only a distance above it matters, so the solver may stop once it knows that h(B,A) is
// not above it.
//
// If the tolerance is relative to the lower bound, the direction that seems to have the larger distance comes first.
// The other distance may be 0, and then a tolerance relative to it would allow no gap. The extra work to find the
// larger direction is included in the counters. The budget applies to each direction.
//
// If the first lower bound is above the cutoff, the second direction is skipped, and the upper bound is infinite. All
// other queries are passed on to the `forward` solver.
class Symmetric final : public Adapter {
public:
    Symmetric(const SolverInfo& info, std::unique_ptr<Solver> forward, std::unique_ptr<Solver> backward);

    std::unique_ptr<State> begin() const override;
    Result solve(const Query& query, State* state, Trace& trace) const override;

private:
    struct Chain;
    struct Opening;

    Result directed(Query query, bool backward, Chain* chain, Trace& trace) const;
    Opening open(Query query, const WallClock& clock, Trace& trace) const;
    Result both(const Query& query, Chain* chain, Trace& trace) const;

    SolverInfo info_;
    std::unique_ptr<Solver> forward_, backward_;
};

// Combines the bounds on two distances, such as h(A,B) and h(B,A), into bounds on the larger distance, in `whole`. The
// witness comes from the result with the larger lower bound, status and note from the result with the larger upper
// bound. Counters are added.
void keep_larger(Result& whole, const Result& other);

}  // namespace hausbench
