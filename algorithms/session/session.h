// One solver on one scene: prepares what is needed, and answers every question that the solver can be made to answer, in the units of
// the input. The work is done by adapters, each a Solver around another:
//
//   Session > Scaled > Symmetric > MovingTarget > PreparedSolver > the solver
//
// `Symmetric` has two MovingTargets, one for each direction. The session itself refuses what cannot be asked, wires the adapters and
// keeps the books of what was prepared.
#pragma once

#include "algorithms/session/scaled.h"

#include <memory>
#include <string>
#include <vector>

namespace hausbench {

// May be shared: several threads may ask one session at the same time, each with a Trace and a State of its own.
class Session {
public:
    // Scales copies of the two shapes (see prepare_pair), builds the structures, by as many threads as a query may use if the solver
    // offers threads, and prepares the solver. Throws InputError for shapes the solver does not take.
    Session(const SolverEntry& entry, const Options& options, const Scene& scene, const QuerySet& queries,
            Leave leave = Leave::out_what_is_not_needed);

    // The same on shapes that are scaled already, both by the same exponent, and that other sessions may share: structures that are
    // there are not built again. Not several at once on one shape.
    Session(const SolverEntry& entry, const Options& options, PreparedPair pair, const QuerySet& queries,
            Leave leave = Leave::out_what_is_not_needed);
    ~Session();
    Session(Session&&) noexcept;

    // The query's lengths (tolerance, floor, cutoff, translations), the result's and the trace's are in the units of the input.
    // The status is held against the bounds: `converged`, `below_floor` and `above_cutoff` are returned only where they are true.
    // How H(A,B) is answered for a solver that does not offer it says symmetric.h; a target that moves, moving_target.h; extreme
    // coordinates, scaled.h.
    //
    // Throws InputError for a tolerance that is not a positive number, a NaN or negative limit, no thread, a pose that is not finite
    // or makes a point that is not, a pose other than the identity of an algebraic surface.
    //
    // `state` is null, or from begin() of this session: one for each chain of poses.
    Result solve(const Query& query, State* state, Trace& trace) const;
    Result solve(const Query& query, Trace& trace) const { return solve(query, nullptr, trace); }

    // Null: the solver carries nothing along.
    std::unique_ptr<State> begin() const;

    // What was built for the first direction. Throws std::logic_error where each answer builds its own.
    const Prepared& prepared() const;
    const Needs& needs() const { return needs_; }

    // For both directions; entries for h(B,A) end in " (B to A)". A structure that both use is there once.
    const std::vector<PreparationTime>& preparation() const { return preparation_; }
    double prepare_seconds() const;
    std::size_t prepare_bytes() const;

private:
    struct Direct;

    void expect(Quantity quantity) const;  // throws where it is not offered
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

// An error text where the solver cannot take these shapes, or does not offer this quantity and Session cannot make it from what
// it does offer; empty where it can.
std::string refusal(const SolverInfo& info, ShapeKind source, ShapeKind target, Quantity quantity = Quantity::directed);

}  // namespace hausbench
