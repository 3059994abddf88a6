// One solver on one scene: scales, prepares what is needed, answers queries in the units of the input; and does for every solver
// what it does not offer itself: H(A,B), and a target that moves.
#pragma once

#include "algorithms/solver.h"

#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace hausbench {

// Which structures to build: those the solver says this scene needs, or all it could ever use (to test that leaving out
// changes no bit of an answer).
enum class Leave { out_what_is_not_needed, nothing_out };

// Both shapes, scaled as a session of their own would scale them. Takes them over, so that no second copy stays.
struct PreparedPair {
    std::shared_ptr<PreparedShape> source, target;
};
PreparedPair prepare_pair(const SolverInfo& info, Shape source, Shape target);

struct ShapeExtent {
    ShapeKind kind;
    double largest;  // |coordinate|
};

// May be shared: several threads may ask one session at the same time, each with a Trace and a State of its own.
class Session {
public:
    // Scales copies of the two shapes by a power of two so that the largest |coordinate| of A and B is in [0.5, 1)
    // (exact but for coordinates below 2^-1000 of it; `original_coordinates` solvers and surfaces stay as they are), builds the
    // structures, by as many threads as a query may use if the solver offers threads, and prepares the solver. Throws InputError for
    // shapes the solver does not take.
    Session(const SolverEntry& entry, const Options& options, const Scene& scene, const QuerySet& queries,
            Leave leave = Leave::out_what_is_not_needed);

    // The same on shapes that are scaled already, both by the same exponent, and that other sessions may share: structures that are
    // there are not built again. Not several at once on one shape.
    Session(const SolverEntry& entry, const Options& options, std::shared_ptr<PreparedShape> source,
            std::shared_ptr<PreparedShape> target, const QuerySet& queries,
            Leave leave = Leave::out_what_is_not_needed);
    Session(const SolverEntry& entry, const Options& options, PreparedPair pair, const QuerySet& queries,
            Leave leave = Leave::out_what_is_not_needed);
    ~Session();
    Session(Session&&) noexcept;

    // The query's lengths (tolerance, floor, cutoff, translations), the result's and the trace's are in the units of the input.
    // Bounds are rounded outward where scaling back is inexact. Starts the trace, and ends it if the solver traces.
    // The status is held against the bounds: `converged`, `below_floor` and `above_cutoff` are returned only where they are true.
    //
    // H(A,B), of a solver that answers directed queries only: first h(A,B), then h(B,A) with the first lower bound as its floor.
    // With a tolerance relative to the lower bound, the direction that seems to be the larger one comes first, so that the other may
    // be 0; finding out which costs some work more.
    // Counters are sums, of all that was tried. Budget: for each of the two. A first lower bound above the cutoff ends it; the upper
    // bound then is infinite.
    // A target that moves, for a solver that does not offer that: a posed copy of B (of A for h(B,A)), over which structures are
    // built again, which counts as solving. Of a solver that lets it (SolverInfo::undoes_target_motion), a rigid motion is undone
    // instead: the source moves the other way, nothing is built, and bounds are wider by about 1e-13 of the coordinates. With a
    // tolerance below about 1e-11 of them, a relative one, or a question of floor and cutoff, it is copied all the same.
    // Poses that bring the scaled coordinates of a shape above largest_safe_coordinate (2^400), or those of both shapes below
    // smallest_safe_magnitude (2^-400), are answered by another session, scaled by the posed extents: its preparation then counts as
    // solving.
    //
    // Throws InputError for a tolerance that is not a positive number, a NaN or negative limit, no thread, a pose that is not finite
    // or makes a point that is not, a pose other than the identity of an algebraic surface.
    //
    // `state` is null, or from begin() of this session: one for each chain of poses. It is left as it is where the answer
    // comes from another session.
    Result solve(const Query& query, State* state, Trace& trace) const;
    Result solve(const Query& query, Trace& trace) const { return solve(query, nullptr, trace); }

    // Null: the solver carries nothing along.
    std::unique_ptr<State> begin() const;

    // Whether the answer to this query builds structures over a posed copy, since a target moves, and neither the solver nor the
    // session has another way. All in one unit of length, whichever.
    static bool copies_targets(const SolverInfo& info, const Query& query, const ShapeExtent& source,
                               const ShapeExtent& target);

    // Of the first direction.
    const Prepared& prepared() const;
    const Needs& needs() const { return needs_; }

    // Of both directions; those of h(B,A) end in " (B to A)". A structure that both use is there once.
    const std::vector<PreparationTime>& preparation() const { return preparation_; }
    double prepare_seconds() const;
    std::size_t prepare_bytes() const;

private:
    struct Part;   // a solver, made and prepared for one direction
    struct Chain;  // the states of both
    struct Clock;
    struct Opening;
    struct Undone;  // the motion of a target

    using Shapes = std::shared_ptr<PreparedShape>;

    void expect(Quantity quantity) const;  // throws where it is not offered
    Options own_options() const;
    Needs needs_of(const Solver& solver, const Scene& scene, const QuerySet& queries) const;
    bool built_for_the_first_direction(const std::string& name) const;
    std::unique_ptr<Part> make_part(const Shapes& source, const Shapes& target, const QuerySet& queries) const;
    void prepare(const std::string& suffix, const Shapes& source, const Shapes& target, QuerySet queries,
                 std::unique_ptr<Part>& part);
    double widening(const PreparedShape& shape, const Pose& pose) const;
    double posed_extent(const PreparedShape& shape, const Pose& pose) const;
    bool leaves_range(const PreparedShape& shape, const Pose& pose, const char* name) const;
    Result solve_rescaled(const Query& query, Trace& trace) const;
    Result directed(const Query& query, bool backward, Chain* chain, Trace& trace) const;
    static std::optional<Undone> undo(double source_largest, const Pose& p, double target_largest, const Pose& g);
    static std::optional<Undone> undo(const SolverInfo& info, const Query& query, const ShapeExtent& source,
                                      const ShapeExtent& target);
    static Query undone(const Query& query, const Undone& undone);
    static void move_back(Result& result, Trace& trace, const Undone& undone);
    Result one_of_both(Query query, bool backward, Chain* chain, Trace& trace) const;
    Opening open(Query query, const Clock& clock, Trace& trace) const;
    Threads builders(const QuerySet& queries) const;
    static void join(Result& whole, const Result& other, bool backward);
    Result symmetric(const Query& query, Chain* chain, Trace& trace) const;
    bool shrinks(const Query& query) const;
    Pose scaled(Pose pose) const;
    Query scaled(const Query& query) const;
    static int usable(int threads);  // no more than the machine has cores
    void scale_back(Result& result, Trace& trace, double wider) const;

    SolverEntry entry_;
    Options options_;
    Leave leave_;
    QuerySet queries_;
    Shapes source_, target_;
    bool scalable_ = false;
    int exponent_ = 0;                          // scaled = original * 2^exponent
    Needs needs_;                               // of the first direction
    std::unique_ptr<Part> forward_, backward_;  // null where each answer makes its own
    std::vector<PreparationTime> preparation_;
};

// Whether the solver's scenes are scaled at all.
bool scalable(const SolverInfo& info, ShapeKind source, ShapeKind target);

// False where a bound is no number, the lower one infinite or the upper one negative.
inline bool may_bound_a_distance(const Bounds& bounds) {
    return bounds.lower < std::numeric_limits<double>::infinity() && bounds.upper >= 0;
}

// An error text where the solver cannot take these shapes, or does not offer this quantity and Session cannot make it of what
// it does; empty where it can.
std::string refusal(const SolverInfo& info, ShapeKind source, ShapeKind target, Quantity quantity = Quantity::directed);

// The larger of two distances, such as those of both directions, from the bounds of each: `whole` becomes that of both, with what shows its
// lower bound and why its upper bound is no smaller. Counters add up.
void keep_larger(Result& whole, const Result& other);

}  // namespace hausbench
