// A solver prepared for one pair of shapes: the innermost adapter of a session (session.h).
#pragma once

#include "algorithms/session/adapter.h"

#include <memory>
#include <optional>
#include <vector>

namespace hausbench {

// Which structures to build: only those that the solver requires for this scene, or everything it could ever use. Tests
// build everything to check that extra structures never change an answer.
enum class Prepare { needed_only, everything };

using SharedPreparedShape = std::shared_ptr<PreparedShape>;

// The structures built for one direction, h(A,B) or h(B,A), with their cost.
struct Books {
    Needs needs;
    std::vector<PreparationTime> times;
};

// Makes any number of solvers with the same options.
class SolverMaker {
public:
    SolverMaker(SolverEntry entry, Options options, Prepare build);

    const SolverInfo& info() const { return entry_.info; }

    // Makes a solver that is not prepared yet. Each solver gets a fresh Options object, because make_solver() checks
    // that every parameter is read.
    std::unique_ptr<Solver> make() const;

    // Returns the structures to build for `solver`, which must come from make().
    Needs needs_of(const Solver& solver, const Scene& scene, const QuerySet& queries) const;

    // Returns the threads that build structures: a single one if the solver does not support threads, so that its times
    // are single-threaded.
    Threads builders(const QuerySet& queries) const;

private:
    SolverEntry entry_;
    Options options_;
    Prepare build_;
};

// Limits `threads` to the number of cores of this machine.
int usable_threads(int threads);

// A prepared solver whose status is checked against its bounds. If the solver reports `converged`, `below_floor` or
// `above_cutoff`, the result has the one of them that follows from the bounds. If none follows, the status becomes
// `stalled`, and a note says why.
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

// Returns whether each bound makes sense for a distance. Returns false if one of them is NaN, the lower bound is
// infinite or the upper bound is negative. Does not compare the bounds with each other.
inline bool may_bound_a_distance(const Bounds& bounds) {
    return bounds.lower < std::numeric_limits<double>::infinity() && bounds.upper >= 0;
}

}  // namespace hausbench
