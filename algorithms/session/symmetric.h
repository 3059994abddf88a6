// H(A,B) = max(h(A,B), h(B,A)), for solvers that answer directed queries only.
#pragma once

#include "algorithms/session/adapter.h"

namespace hausbench {

// First h(A,B), then h(B,A) with the first lower bound as its floor. With a tolerance relative to the lower bound, the direction that
// seems to be the larger one comes first, so that the other may be 0; finding out which costs some work more.
// Counters are sums, of all that was tried. Budget: for each of the two. A first lower bound above the cutoff ends it; the upper
// bound then is infinite. Other queries go to `forward` as they are.
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

// The larger of two distances, such as those of both directions, from the bounds of each: `whole` becomes the larger one, with what
// shows its lower bound and why its upper bound is no smaller. Counters add up.
void keep_larger(Result& whole, const Result& other);

}  // namespace hausbench
