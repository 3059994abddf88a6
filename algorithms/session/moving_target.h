// A target that moves, for solvers that offer only a source that moves.
#pragma once

#include "algorithms/session/prepared_solver.h"

namespace hausbench {

struct ShapeExtent {
    ShapeKind kind;
    double largest;  // |coordinate|
};

// One direction of a session. A target that moves is answered in one of three ways:
// - by the solver, if it offers that;
// - undone: if the solver allows it (Ability::undone_motion), both shapes are meshes and the motion is rigid, the source
//   moves the other way, nothing is built, and bounds are wider by about 1e-13 of the coordinates. Not with a tolerance below about
//   1e-11 of them, a relative one, a question of floor and cutoff, or where a certificate is wanted, which would be of other poses;
// - copied: the target is posed and structures are built over the copy, which counts as solving.
class MovingTarget final : public Adapter {
public:
    // Nothing is prepared: unless keep() is called, each answer prepares for itself.
    MovingTarget(std::shared_ptr<const SolverMaker> maker, SharedPreparedShape source, SharedPreparedShape target,
                 const QuerySet& queries);

    // Prepares for all answers to come. Where each of them is over a copy, only what stands over the source.
    Books keep();

    // Null where each answer is over a copy.
    const Prepared* prepared() const { return kept_ ? &kept_->prepared() : nullptr; }

    std::unique_ptr<State> begin() const override;
    Result solve(const Query& query, State* state, Trace& trace) const override;

private:
    struct Chain;

    std::unique_ptr<PreparedSolver> prepared_over_a_copy(Query& query) const;

    std::shared_ptr<const SolverMaker> maker_;
    SharedPreparedShape source_, target_;
    QuerySet queries_;
    std::unique_ptr<PreparedSolver> kept_;
};

// Whether the answer to this query builds structures over a copy of a target. Lengths are all in one unit, whichever.
bool copies_targets(const SolverInfo& info, const Query& query, const ShapeExtent& source, const ShapeExtent& target);

}  // namespace hausbench
