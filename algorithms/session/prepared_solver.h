// A solver made and prepared for one pair of shapes: what all adapters of a session stand on.
#pragma once

#include "algorithms/session/adapter.h"

#include <memory>
#include <optional>
#include <vector>

namespace hausbench {

// Which structures to build: those the solver says this scene needs, or all it could ever use (to test that leaving out
// changes no bit of an answer).
enum class Leave { out_what_is_not_needed, nothing_out };

using SharedPreparedShape = std::shared_ptr<PreparedShape>;

// What was built for one direction, and what it cost.
struct Books {
    Needs needs;
    std::vector<PreparationTime> times;
};

// Makes as many solvers of one kind, with the same options, as a session needs.
class SolverMaker {
public:
    SolverMaker(SolverEntry entry, Options options, Leave leave);

    const SolverInfo& info() const { return entry_.info; }

    // A solver that is not prepared yet. Its options are unread, as check_contract() wants them.
    std::unique_ptr<Solver> make() const;

    Needs needs_of(const Solver& solver, const Scene& scene, const QuerySet& queries) const;

    // A solver without threads has its structures built by one, so that its time is that of one thread.
    Threads builders(const QuerySet& queries) const;

private:
    SolverEntry entry_;
    Options options_;
    Leave leave_;
};

// No more threads than the machine has cores.
int usable_threads(int threads);

// Holds the solver's word against its bounds: `converged`, `below_floor` and `above_cutoff` stay only where they follow from the
// bounds; else the status becomes `stalled`, and a note says why. Lengths are scaled by the exponent of the shapes.
class PreparedSolver final : public Adapter {
public:
    PreparedSolver(const SolverMaker& maker, const SharedPreparedShape& source, const SharedPreparedShape& target,
                   const QuerySet& queries);

    std::unique_ptr<State> begin() const override { return solver_->begin(); }
    Result solve(const Query& query, State* state, Trace& trace) const override;

    const Prepared& prepared() const { return *prepared_; }
    Books books() const;

private:
    int exponent_;
    Scene scene_;
    std::unique_ptr<Solver> solver_;
    Needs needs_;
    std::optional<Prepared> prepared_;
    double solver_seconds_ = 0;
};

// False where a bound is no number, the lower one infinite or the upper one negative.
inline bool may_bound_a_distance(const Bounds& bounds) {
    return bounds.lower < std::numeric_limits<double>::infinity() && bounds.upper >= 0;
}

}  // namespace hausbench
