// H(A,B) = max(h(A,B), h(B,A)), for solvers that answer directed queries only.
#pragma once

#include "algorithms/session/adapter.h"

namespace hausbench {

// Asks for h(A,B), then for h(B,A) with the first lower bound as its floor. With a tolerance relative to the lower bound, the
// direction that seems larger comes first, because the other one may be 0; finding out which one costs some extra work.
// Counters add up everything that was tried. The budget applies to each direction. If the first lower bound is above the cutoff,
// the second direction is not measured and the upper bound is infinite. Other queries are passed on to `forward`.
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

// Turns `whole` into bounds of the larger of two distances, such as the two directions of H. Takes the witness from the larger
// lower bound, status and note from the larger upper bound, and adds counters.
void keep_larger(Result& whole, const Result& other);

}  // namespace hausbench
