// THE interface. A solver bounds the directed Hausdorff distance h(A,B) = max over a in A of min over b in B of |a - b|
// from below and above. One solver is one .cpp file without a header: it defines a class, a SolverInfo and one function
// that the CMakeLists.txt of its folder names. Read points/naive.cpp next.
//
// A solver must honour of a query: its poses, its tolerance, and `quantity` and `wanted` as far as its SolverInfo offers them.
// All else in it is a permission that a solver may ignore. What a solver does not offer, Session does for it: H(A,B) = max of
// h(A,B) and h(B,A) from two directed answers, and a target that moves, from a posed copy.
//
// What a solver may rely on (session.h sees to it): shapes are non-empty and finite, and unless it asks for
// `original_coordinates` the scene is scaled by a power of two so that the largest |coordinate| is in [0.5, 1). Scenes
// with an algebraic surface are never scaled.
#pragma once

#include "algorithms/kernel/counters.h"
#include "algorithms/options.h"
#include "algorithms/prepared.h"
#include "algorithms/scene.h"
#include "algorithms/trace.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hausbench {

struct ShapeSet {
    bool points = false, mesh = false, surface = false;
    bool contains(ShapeKind kind) const {
        return kind == ShapeKind::points ? points : kind == ShapeKind::mesh ? mesh : surface;
    }
};

// How small the gap upper - lower must get.
struct Tolerance {
    enum class Of { absolute, lower };  // a length, or a fraction of the lower bound
    Of of = Of::absolute;
    double value = 0;

    // The gap that is small enough, given the lower bound so far.
    double gap(double lower) const { return of == Of::absolute ? value : value * lower; }
};

enum class Status {
    converged,     // the gap is within the tolerance; with a floor it is upper - max(lower, floor)
    below_floor,   // upper <= floor: of no interest
    above_cutoff,  // lower > cutoff: known well enough
    time_limit,
    budget,           // Query::budget subdivisions (or the solver's own unit of work, see its header) were spent
    precision_floor,  // the tolerance is below what double precision can certify
    stalled,          // the solver cannot go on; the bounds still hold
};
std::string_view to_string(Status status);

struct Bounds {
    double lower = 0;
    double upper = std::numeric_limits<double>::infinity();

    double gap() const { return upper - lower; }
};

// A pair that shows the lower bound. Whatever the direction, source_point lies on A posed and target_point on B posed; the
// direction says which of the two is far from the other shape: the other point is its closest point there. NaN: a point that is
// unknown, or that was not computed.
struct Witness {
    enum class Direction { source_to_target, target_to_source };
    Vec3 source_point = Vec3::Constant(std::numeric_limits<double>::quiet_NaN()), target_point = source_point;
    Index source_element = -1, target_element = -1;  // -1: unknown (peers that do not tell)
    Direction direction = Direction::source_to_target;
};
std::string_view to_string(Witness::Direction direction);

// What a solver reports of itself, by name: a number, such as the share of points that it culled, or a text, such as the algorithm
// that it chose. Session scales a number back whose name begins with `length_prefix`, to the nearest: it is no bound.
inline constexpr std::string_view length_prefix = "length: ";
using Reported = std::map<std::string, std::variant<double, std::string>>;

// A value for each vertex or each element of A, such as the upper bound of each triangle. Only draw_distance() of fields.h cuts A
// into pieces.
struct Field {
    enum class Of { vertices, elements, pieces };
    enum class Meaning { lower, upper, number };  // bounds of a distance are lengths; numbers have no unit
    std::string name;
    Of of = Of::elements;
    Meaning meaning = Meaning::number;
    std::vector<double> values;
};
using Fields = std::vector<Field>;

// A proof of the upper bound `proven` that can be checked without the solver; `format` says how to read the bytes. All that is a length
// stands in `proven`: the bytes hold for the shapes in every unit.
struct Certificate {
    std::string format;
    Witness::Direction direction = Witness::Direction::source_to_target;  // target_to_source: of h(B,A)
    double proven = std::numeric_limits<double>::infinity();
    std::string bytes;
};

struct Result {
    Status status = Status::stalled;
    Bounds bounds;  // lower <= the quantity of the query <= upper, whatever the status
    Witness witness;
    Counters counters;
    Reported reported = {};

    // One line: why the status is not `converged`, where the solver knows more than the status says.
    std::string note = {};

    std::optional<Fields> fields = {};           // only where the query wants them
    std::vector<Certificate> certificates = {};  // likewise; for H(A,B) one for each direction, or none
    std::string why_no_certificate = {};         // one line, where one was wanted and there is none

    // Where a program outside this process did the work: its own measure of its time, and its peak resident set.
    double reported_seconds = std::numeric_limits<double>::quiet_NaN();
    std::int64_t outside_bytes = -1;
};

// h(A,B); H(A,B); or how deep two solids are in each other: over the connected parts of the volume that they have in common, the largest H
// of the part's boundary that is of A and the one that is of B (Tang et al. 2009, section 7.3; see composed/penetration/penetration.cpp).
enum class Quantity { directed, symmetric, penetration };
inline constexpr Quantity quantities[] = {Quantity::directed, Quantity::symmetric, Quantity::penetration};
std::string_view to_string(Quantity quantity);

// "h(A,B)", "H(A,B)", "the penetration depth".
std::string_view symbol(Quantity quantity);

// What an answer is to hold beside its bounds. Not asked for where solving is timed.
struct Wanted {
    bool fields = false;
    bool stages = false;  // in `reported`: seconds by stage, as "seconds: subdivide"
    bool certificate = false;
};
inline constexpr std::string_view stage_prefix = "seconds: ";

struct Query {
    Quantity quantity = Quantity::directed;
    Pose source_pose, target_pose;
    Tolerance tolerance;
    // Two permissions to stop early, as lengths, which a solver may ignore. "Is h above d?" is floor = cutoff = d; the tolerance
    // then ends nothing. The lower bound is proven and has its witness all the same: it is never the floor.
    double floor = 0;                                             // may stop once upper <= floor
    double cutoff = std::numeric_limits<double>::infinity();      // may stop once lower > cutoff
    double time_limit = std::numeric_limits<double>::infinity();  // seconds of wall time
    std::uint64_t budget = std::numeric_limits<std::uint64_t>::max();
    int threads = 1;  // at most so many may work; the interval must not depend on it
    Wanted wanted;

    // The status that a solver with these bounds may end with, if they are close enough for any. What is below the floor does
    // not count: the gap is upper - max(lower, floor).
    std::optional<Status> answer(double lower, double upper) const {
        if (lower > cutoff) return Status::above_cutoff;
        const bool asks = floor >= cutoff;
        if (upper <= floor && (floor > 0 || asks)) return Status::below_floor;
        if (!asks && upper - (lower > floor ? lower : floor) <= tolerance.gap(lower)) return Status::converged;
        return std::nullopt;
    }
};

// What all queries to come have in common, so that a solver can leave out what they do not need.
struct QuerySet {
    bool moves = false;  // some pose of A is not the identity
    std::size_t count = 1;
    double finest_tolerance = 0;
    bool target_moves = false;   // some pose of B is not the identity
    bool target_copied = false;  // and some answer is over a posed copy, see session/moving_target.h
    bool symmetric = false;      // H(A,B) is asked for
    int threads = 1;             // the most that a query may use; so many may build structures
};

// What a solver keeps from one pose of a chain to the next, such as the last witness. It may speed up an answer, and never changes
// what a bound means. A chain may go on with another instance of the solver, prepared on the same shapes in another pose.
class State {
public:
    virtual ~State() = default;

    // `opposite` is the state of the other direction of H(A,B) at the same pose: what lay close together there does so here too. For
    // solvers with Ability::shared_pairs.
    virtual void learn_from(const State& /*opposite*/) {}
};

class Solver {
public:
    virtual ~Solver() = default;

    // Whether the bounds hold under rounding under the options given; asked where SolverInfo::certified says that they can,
    // of a solver that is made for nothing else, so constructors only read options.
    virtual bool certified() const { return true; }

    // Only what THIS scene and THESE queries call for: a few plain ifs.
    virtual Needs needs(const Scene&, const QuerySet&) const { return {}; }

    // Builds what the solver keeps to itself; timed apart from solve. Both arguments outlive the solver's last solve.
    virtual void prepare(const Scene& scene, const Prepared& prepared) = 0;

    // Memory of what prepare() built, in bytes; 0 where the solver keeps nothing of note.
    virtual std::size_t prepared_bytes() const { return 0; }

    // What a chain of nearby poses carries along, for solvers with Ability::warm; null: each answer is cold.
    virtual std::unique_ptr<State> begin() const { return nullptr; }

    // Const and re-entrant: nothing changes but `state`, which is null or from begin() and belongs to one chain of queries, so
    // that the order of other queries cannot matter. Never throws for hard input: returns `stalled` with bounds that hold.
    virtual Result solve(const Query& query, State* state, Trace& trace) const = 0;
};

// What a solver can do beyond bounding h(A,B) of a source that moves.
enum class Ability {
    traces,         // offers samples to Trace
    moving_target,  // honours Query::target_pose
    warm,           // makes use of a State
    shared_pairs,   // and of the State of the other direction, see State::learn_from
    threads,        // makes use of Query::threads
    fields,         // gives Result::fields where they are wanted
    certificates,   // gives Result::certificates where they are wanted and it had the time for it

    // The tolerance only says when to stop: the trace holds the answers to coarser ones, bit for bit, so that
    // the harness reads them there.
    coarser_answers,

    // Bounds that are a little wider do no harm: where a mesh as target moves rigidly, Session may move the
    // source the other way instead of building structures again over a posed copy.
    undone_motion,
};
std::string_view to_string(Ability ability);

struct SolverInfo {
    std::string name;   // as in experiment files
    std::string title;  // as in tables and legends
    std::string paper;  // key in papers.bib; empty: our own, and the title ends with "(ours)"
    ShapeSet source, target;

    // The bounds hold under rounding, by a bound derived in the solver's file; see Solver::certified.
    bool certified = false;

    // A published error that is kept to show it: why bounds may not hold. Never certified.
    std::string known_wrong = {};

    // The answer is the same whatever the tolerance: the true distance, or bounds that are as wide as they are.
    bool ignores_tolerance = false;

    // Takes the scene unscaled: outside programs, so that their limits can be seen.
    bool original_coordinates = false;

    std::vector<Quantity> quantities = {Quantity::directed};
    std::set<Ability> abilities = {};
    Needs may_need = {};  // every structure it can ever use
    std::vector<ParameterSpec> parameters = {};

    bool offers(Quantity quantity) const {
        return std::find(quantities.begin(), quantities.end(), quantity) != quantities.end();
    }
    bool can(Ability ability) const { return abilities.contains(ability); }
};

struct SolverEntry {
    SolverInfo info;
    std::unique_ptr<Solver> (*make)(const Options&);
};

// For SolverEntry::make, of a solver that is constructed from its options.
template <class AnySolver> std::unique_ptr<Solver> make_solver(const Options& options) {
    return std::make_unique<AnySolver>(options);
}

}  // namespace hausbench
