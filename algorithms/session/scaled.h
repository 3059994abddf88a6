// Scales the shapes, so that a solver works with coordinates of about 1, whatever the unit of the input.
#pragma once

#include "algorithms/session/prepared_solver.h"

#include <functional>

namespace hausbench {

// Both shapes, scaled by the same power of two.
struct PreparedPair {
    SharedPreparedShape source, target;
};

// Scales both shapes by the power of two that brings the largest |coordinate| into [0.5, 1). This is exact except for
// coordinates that are smaller than the largest one by a factor of more than 2^1000. If scalable() is false, the
// shapes stay as they are. Takes the shapes by value, so that no second copy of them needs to stay in memory.
PreparedPair prepare_pair(const SolverInfo& info, Shape source, Shape target);

// Returns whether a scene of these kinds of shapes is scaled for this solver: not if it asks for
// `original_coordinates`, and not if one of the shapes is a surface.
bool scalable(const SolverInfo& info, ShapeKind source, ShapeKind target);

// Takes queries and gives answers in the unit of the input; the wrapped solver works on scaled shapes. Bounds are
// widened by the error of scaling and posing the shapes, and rounded outward if scaling them back is inexact. Starts
// the trace; ends it, too, if the solver has Ability::traces.
//
// Some poses bring the scaled coordinates of a shape above largest_safe_coordinate (2^400), or the scaled coordinates
// of both shapes below smallest_safe_magnitude (2^-400). A query with such a pose is answered by another solver, which
// is made for the posed shapes, scaled anew. The time to make it counts as time of the answer, and `state` is not
// used. Throws InputError for a pose that moves a surface or makes a point that is not finite.
class Scaled final : public Adapter {
public:
    using Make = std::function<std::unique_ptr<Solver>(const PreparedPair&, const QuerySet&)>;

    // `solver` must be prepared for `pair`; `make` makes a solver that is prepared for another pair.
    Scaled(const SolverInfo& info, PreparedPair pair, std::unique_ptr<Solver> solver, Make make);

    std::unique_ptr<State> begin() const override { return solver_->begin(); }
    Result solve(const Query& query, State* state, Trace& trace) const override;

private:
    bool leaves_range(const PreparedShape& shape, const Pose& pose, const char* name) const;
    bool shrinks(const Query& query) const;
    PreparedPair at_rest(const Query& query) const;
    Result answer(const Solver& solver, const PreparedPair& pair, const Query& query, State* state, Trace& trace) const;

    SolverInfo info_;
    PreparedPair pair_;
    bool scalable_;
    std::unique_ptr<Solver> solver_;
    Make make_;
};

}  // namespace hausbench
