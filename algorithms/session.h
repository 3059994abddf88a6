// One solver on one scene: scales, prepares what is needed, answers queries in the units of the input.
#pragma once

#include "solver.h"

#include <memory>
#include <vector>

namespace hausbench {

// Which structures to build: those the solver says this scene needs, or all it could ever use (to test that leaving out
// changes no bit of an answer).
enum class Leave { out_what_is_not_needed, nothing_out };

class Session {
public:
    // Takes the scene over, scales it by a power of two so that the largest |coordinate| of A and B is in [0.5, 1)
    // (exact but for coordinates below 2^-1000 of it; `original_coordinates` solvers and surfaces stay as they are), builds the
    // structures, prepares the solver. Throws InputError for shapes the solver does not take. Keeps a copy of the scene only
    // where scaling was not exact.
    Session(const SolverEntry& entry, const Options& options, Scene scene, const QuerySet& queries,
            Leave leave = Leave::out_what_is_not_needed);

    // The query's lengths (tolerance, floor, cutoff, translation), the result's and the trace's are in the units of the input.
    // Bounds are rounded outward where scaling back is inexact. Starts the trace, and ends it if the solver traces.
    // The status is held against the bounds: `converged`, `below_floor` and `above_cutoff` are returned only where they are true.
    // A pose that moves A so far that the scaled coordinates pass largest_safe_coordinate (2^400) is answered by another
    // session, scaled by the posed extents: its preparation then counts as solving.
    // Throws InputError for a tolerance that is not a positive number, a NaN or negative limit, a pose that is not finite or
    // makes a point that is not, a pose other than the identity where the source is an algebraic surface.
    //
    // `state` is null, or from begin() of this session: one for each chain of poses. It is left as it is where the answer
    // comes from another session.
    Result solve(const Query& query, State* state, Trace& trace) const;
    Result solve(const Query& query, Trace& trace) const { return solve(query, nullptr, trace); }

    // Null: the solver carries nothing along.
    std::unique_ptr<State> begin() const { return solver_->begin(); }

    const Prepared& prepared() const { return *prepared_; }
    const Needs& needs() const { return needs_; }
    const std::vector<PreparationTime>& preparation() const { return preparation_; }
    double prepare_seconds() const;
    std::size_t prepare_bytes() const;

private:
    double widening(const Pose& pose) const;
    double posed_extent(const Pose& pose) const;
    Points original(Side side) const;
    Result solve_rescaled(const Query& query, Points source, Trace& trace) const;
    Query scaled(const Query& query) const;
    void scale_back(Result& result, Trace& trace, double wider) const;

    SolverEntry entry_;
    Options options_;
    Leave leave_;
    std::unique_ptr<Scene> scene_;
    std::unique_ptr<Scene> original_;  // only where scaling was not exact
    bool moveable_ = true;             // the source may be posed: it is no algebraic surface
    bool scalable_ = false;
    int exponent_ = 0;                          // scaled = original * 2^exponent
    double lost_source_ = 0, lost_target_ = 0;  // 2^-1074 where a scaled coordinate was rounded, else 0
    double largest_ = 0, smallest_ = 0;         // nonzero |coordinate| of the source, scaled
    Needs needs_;
    std::unique_ptr<Prepared> prepared_;
    std::unique_ptr<Solver> solver_;
    std::vector<PreparationTime> preparation_;
};

// An error text where the solver cannot take these shapes, empty where it can.
std::string refusal(const SolverInfo& info, ShapeKind source, ShapeKind target);

}  // namespace hausbench
