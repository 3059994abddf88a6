// Gives a solver coordinates of about 1, whatever the unit of the input.
#pragma once

#include "algorithms/session/prepared_solver.h"

#include <functional>

namespace hausbench {

// Both shapes, scaled by the same power of two.
struct PreparedPair {
    SharedPreparedShape source, target;
};

// Scales both shapes by the power of two that brings the largest |coordinate| into [0.5, 1). This is exact except for
// coordinates below 2^-1000 of it. `original_coordinates` solvers and surfaces are not scaled. Takes the shapes by value so that no
// second copy stays in memory.
PreparedPair prepare_pair(const SolverInfo& info, Shape source, Shape target);

// Returns whether the solver's scenes are scaled at all.
bool scalable(const SolverInfo& info, ShapeKind source, ShapeKind target);

// Takes queries and gives answers in the unit of the input; the wrapped solver works on scaled shapes. Bounds are rounded outward
// if scaling back is inexact, and widened by the error of scaling and posing the shapes. Starts the trace, and ends it if the
// solver traces.
//
// Some poses bring the scaled coordinates of a shape above largest_safe_coordinate (2^400), or the coordinates of both shapes below
// smallest_safe_magnitude (2^-400). They are answered by another solver, made for the posed shapes at a scale of their own; making it
// counts as solving, and `state` is not used. Throws InputError for a pose that moves a surface or makes a point that is not finite.
class Scaled final : public Adapter {
public:
    using Make = std::function<std::unique_ptr<Solver>(const PreparedPair&, const QuerySet&)>;

    // `solver` must be prepared for `pair`; `make` makes a solver for another pair.
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
