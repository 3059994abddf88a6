// Emulates a moving target for solvers that support only a moving source.
#pragma once

#include "algorithms/session/prepared_solver.h"

namespace hausbench {

// The kind and size of a shape, which decide how MovingTarget emulates its motion.
struct ShapeExtent {
    ShapeKind kind;
    double largest;  // the largest |coordinate| before any motion
};

// Solves one direction of a session, h(A,B) or h(B,A). A query with a moving target is answered in one of three ways:
// - If the solver has Ability::moving_target, it gets the query as it is.
// - If possible, the motion of the target is undone: the target stays where it is, and the source is moved by the
//   inverse motion instead. No structure is built, but bounds widen by about 1e-13 times the largest coordinates. This
//   requires Ability::undone_motion, two meshes, a rigid motion, and an absolute tolerance above about 1e-11 times the
//   largest coordinates. It is not done for a yes/no question (floor >= cutoff), nor if a certificate is wanted,
//   because the certificate would be about other poses.
// - Otherwise the target is copied and the copy is moved. Structures over the copy are built for this answer alone, and
//   the time to build them counts as time of the answer.
class MovingTarget final : public Adapter {
public:
    // Prepares nothing yet. Call keep() to prepare one solver for all answers; otherwise each answer prepares its own.
    MovingTarget(std::shared_ptr<const SolverMaker> maker, SharedPreparedShape source, SharedPreparedShape target,
                 const QuerySet& queries);

    // Prepares one solver for all later answers. Returns the structures that were built, with their cost. If every
    // answer must copy the target, prepares no solver and builds only the structures over the source.
    Books keep();

    // Returns the structures of the solver that keep() prepared, or null if there is none.
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

// Returns whether answering this query needs structures over a moved copy of a shape: of the target or, if H(A,B) is
// computed as two directions, of either shape. The query and the extents must use the same unit of length.
bool copies_targets(const SolverInfo& info, const Query& query, const ShapeExtent& source, const ShapeExtent& target);

}  // namespace hausbench
