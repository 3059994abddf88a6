// Runs one solver on one pair of shapes: builds the structures that the solver needs and answers queries in the unit of
// the input. Adapters, which are solvers that wrap other solvers, emulate the features that the solver lacks:
//
//     Session > Scaled > Symmetric > MovingTarget > PreparedSolver > the solver
//
// `Symmetric` has two MovingTargets, one for each direction. The session itself checks queries, connects the adapters
// and records the cost of preparation.
#pragma once

#include "algorithms/session/scaled.h"

#include <memory>
#include <string>
#include <vector>

namespace hausbench {

// Thread-safe: several threads may query one session at the same time, each with a Trace and a State of its own.
class Session {
public:
    // Scales copies of the two shapes (see prepare_pair), builds the structures and prepares the solver. Uses
    // queries.threads threads if the solver supports threads. Throws InputError if the solver does not accept the
    // shapes.
    Session(const SolverEntry& entry, const Options& options, const Scene& scene, const QuerySet& queries,
            Prepare build = Prepare::needed_only);

    // Like the constructor above, but for shapes that are scaled already, both by the same exponent. Several sessions
    // may share such shapes and the structures built over them. Do not construct two sessions on one shape at the same
    // time.
    Session(const SolverEntry& entry, const Options& options, PreparedPair pair, const QuerySet& queries,
            Prepare build = Prepare::needed_only);
    ~Session();
    Session(Session&&) noexcept;

    // Answers a query. All lengths (tolerance, floor, cutoff, translations, bounds, trace) are in the unit of the
    // input. The status `converged`, `below_floor` or `above_cutoff` is returned only if the bounds justify it. See
    // symmetric.h for how H(A,B) is emulated, moving_target.h for moving targets, and scaled.h for extreme coordinates.
    //
    // Throws InputError for a tolerance that is not a positive number, a limit that is NaN or negative, fewer than one
    // thread, a pose that is not finite or makes a point that is not finite, and a moved algebraic surface.
    //
    // `state` is null or comes from begin() of this session. Use one state for each chain of nearby poses.
    Result solve(const Query& query, State* state, Trace& trace) const;
    Result solve(const Query& query, Trace& trace) const { return solve(query, nullptr, trace); }

    // Returns a state for a chain of nearby poses, with which the solver reuses earlier results. Returns null if the
    // solver does not support this (Ability::warm).
    std::unique_ptr<State> begin() const;

    // Returns the structures for h(A,B). Throws std::logic_error if the session keeps none because each answer builds
    // its own.
    const Prepared& prepared() const;
    const Needs& needs() const { return needs_; }

    // Returns the cost of preparation, with one entry for each structure and each solver. Names of entries for h(B,A)
    // end in " (B to A)". A structure that both directions use is listed once, for h(A,B).
    const std::vector<PreparationTime>& preparation() const { return preparation_; }
    double prepare_seconds() const;
    std::size_t prepare_bytes() const;

private:
    struct Direct;

    void expect(Quantity quantity) const;  // throws InputError if the quantity is neither supported nor emulated
    static Direct wired(const std::shared_ptr<const SolverMaker>& maker, const PreparedPair& pair,
                        const QuerySet& queries);
    void keep_books(Books books, const std::string& suffix);
    bool built_for_the_first_direction(const std::string& name) const;

    std::shared_ptr<const SolverMaker> maker_;
    PreparedPair pair_;
    std::unique_ptr<Scaled> solver_;
    const Prepared* prepared_ = nullptr;
    Needs needs_;
    std::vector<PreparationTime> preparation_;
};

// Returns an error message if the solver does not accept these shapes, or if it does not support the quantity and
// Session cannot emulate it. Returns an empty string if the solver can be used.
std::string refusal(const SolverInfo& info, ShapeKind source, ShapeKind target, Quantity quantity = Quantity::directed);

}  // namespace hausbench
