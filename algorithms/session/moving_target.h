// Moving targets, for solvers that support only a moving source.
#pragma once

#include "algorithms/session/prepared_solver.h"

namespace hausbench {

struct ShapeExtent {
    ShapeKind kind;
    double largest;  // |coordinate|
};

// One direction of a session. It answers a query with a moving target in one of three ways:
// - The solver does it, if it has Ability::moving_target.
// - The motion is undone: the source moves the other way, nothing is built, and bounds widen by about 1e-13 of the
//   coordinates. This requires Ability::undone_motion, two meshes, a rigid motion and an absolute tolerance above about 1e-11
//   of the coordinates. It is not done for a yes/no question, nor if a certificate is wanted, because the certificate would
//   be about other poses.
// - The target is copied: structures are built over the posed copy, which counts as solving.
class MovingTarget final : public Adapter {
public:
    // Prepares nothing: unless keep() is called, each answer prepares a solver of its own.
    MovingTarget(std::shared_ptr<const SolverMaker> maker, SharedPreparedShape source, SharedPreparedShape target,
                 const QuerySet& queries);

    // Prepares for all later answers. If every answer needs a copy, builds only the structures over the source.
    Books keep();

    // Null if every answer needs a copy.
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

// Returns whether the answer to this query builds structures over a copy of a target. All lengths must share one unit.
bool copies_targets(const SolverInfo& info, const Query& query, const ShapeExtent& source, const ShapeExtent& target);

}  // namespace hausbench
