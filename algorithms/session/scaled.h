// A solver that sees coordinates of about 1, whatever the unit of the input.
#pragma once

#include "algorithms/session/prepared_solver.h"

#include <functional>

namespace hausbench {

// Both shapes, scaled by the same power of two.
struct PreparedPair {
    SharedPreparedShape source, target;
};

// Scales by the power of two that brings the largest |coordinate| of both into [0.5, 1); exact but for coordinates below 2^-1000 of
// it. `original_coordinates` solvers and surfaces stay as they are. Takes the shapes over, so that no second copy stays.
PreparedPair prepare_pair(const SolverInfo& info, Shape source, Shape target);

// Whether the solver's scenes are scaled at all.
bool scalable(const SolverInfo& info, ShapeKind source, ShapeKind target);

// Takes queries and gives answers in the unit of the input, of a solver of the scaled shapes. Bounds are rounded outward where scaling
// back is inexact, and wider by what scaling and posing the shapes has lost. Starts the trace, and ends it if the solver traces.
//
// Poses that bring the scaled coordinates of a shape above largest_safe_coordinate (2^400), or those of both shapes below
// smallest_safe_magnitude (2^-400), are answered by a solver of the posed shapes, scaled by their extents: making it then counts as
// solving, and the state is left as it is. Throws InputError for a pose that makes a point that is not finite, or that moves a surface.
class Scaled final : public Adapter {
public:
    using Make = std::function<std::unique_ptr<Solver>(const PreparedPair&, const QuerySet&)>;

    // `solver` is for the pair as it is; `make` makes one for another pair.
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
