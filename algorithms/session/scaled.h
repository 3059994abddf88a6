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
// coordinates more than 2^1000 times smaller than the largest one. If scalable() is false, the shapes stay as they are.
PreparedPair prepare_pair(const SolverInfo& info, Shape source, Shape target);

// Returns whether shapes of these kinds are scaled for this solver. Returns false if the solver asks for
// `original_coordinates`, or if a shape is an algebraic surface.
bool scalable(const SolverInfo& info, ShapeKind source, ShapeKind target);

// Takes queries and gives answers in the unit of the input, while the wrapped solver works on scaled shapes. Bounds are
// widened by the error of scaling and posing the shapes, and rounded outward if scaling them back is inexact. Starts
// the trace; ends it, too, if the solver has Ability::traces.
//
// Some poses bring the scaled coordinates of a shape above largest_safe_coordinate (2^400), or the scaled coordinates
// of both shapes below smallest_safe_magnitude (2^-400). Such a query is answered by another solver, made for the posed
// shapes after scaling them anew. The time to make it counts as time of the answer, and `state` is not used. Throws
// InputError for a pose that moves a surface or makes a point that is not finite.
class Scaled final : public Adapter {
public:
    using Make = std::function<std::unique_ptr<Solver>(const PreparedPair&, const QuerySet&)>;

    // `solver` must be prepared for `pair`. `make` returns a solver prepared for another pair of shapes.
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
