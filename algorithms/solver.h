// THE interface. A solver bounds the directed Hausdorff distance h(A,B) = max over a in A of min over b in B of |a - b|
// from below and above. One solver is one .cpp file without a header: it defines a class, a SolverInfo and one function
// that the CMakeLists.txt of its folder names. Read points/naive.cpp next.
//
// A solver must honour the poses and the tolerance of a query, and `quantity` and `wanted` as far as its SolverInfo offers
// them. All other fields are optional hints. Session emulates what a solver does not support: H(A,B) = max(h(A,B), h(B,A))
// from two directed answers, and a moving target from a posed copy.
//
// A solver may rely on the following, which session.h ensures: shapes are non-empty and finite, and unless it asks for
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

// The largest gap, upper - lower, that ends a search.
struct Tolerance {
    enum class Of { absolute, lower };  // a length, or a fraction of the lower bound
    Of of = Of::absolute;
    double value = 0;

    // Returns the largest gap allowed, given the lower bound so far.
    double gap(double lower) const { return of == Of::absolute ? value : value * lower; }
};

enum class Status {
    converged,     // the gap is within the tolerance; with a floor it is upper - max(lower, floor)
    below_floor,   // upper <= floor
    above_cutoff,  // lower > cutoff
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

// The pair of points that attains the lower bound. In either direction source_point lies on A posed and target_point on B
// posed. `direction` says which of the two is far from the other shape; the other one is its closest point there. NaN means
// that a point is not known.
struct Witness {
    enum class Direction { source_to_target, target_to_source };
    Vec3 source_point = Vec3::Constant(std::numeric_limits<double>::quiet_NaN()), target_point = source_point;
    Index source_element = -1, target_element = -1;  // -1: not known
    Direction direction = Direction::source_to_target;
};
std::string_view to_string(Witness::Direction direction);

// Facts that a solver reports about its run, by name: a number, such as the share of points it culled, or a text, such as the
// algorithm it chose. Session scales numbers whose name begins with `length_prefix` back to the unit of the input, rounded to
// nearest, so they are not bounds.
inline constexpr std::string_view length_prefix = "length: ";
using Reported = std::map<std::string, std::variant<double, std::string>>;

// One value for each vertex or element of A, such as the upper bound of each triangle. Only draw_distance() in
// harness/record/fields.h makes fields of pieces.
struct Field {
    enum class Of { vertices, elements, pieces };
    enum class Meaning { lower, upper, number };  // bounds are lengths, numbers have no unit
    std::string name;
    Of of = Of::elements;
    Meaning meaning = Meaning::number;
    std::vector<double> values;
};
using Fields = std::vector<Field>;

// A proof of the upper bound `proven` that can be checked without the solver. `format` says how to read the bytes. The bytes
// contain no length, so they hold for the shapes in every unit; the only length is `proven`.
struct Certificate {
    std::string format;
    Witness::Direction direction = Witness::Direction::source_to_target;  // target_to_source: proves h(B,A)
    double proven = std::numeric_limits<double>::infinity();
    std::string bytes;
};

struct Result {
    Status status = Status::stalled;
    Bounds bounds;  // lower <= the quantity of the query <= upper, whatever the status
    Witness witness;
    Counters counters;
    Reported reported = {};

    // One line that says why the status is not `converged`, if the solver knows more than the status tells.
    std::string note = {};

    // Set only if the query wants them. H(A,B) has two certificates, one for each direction, or none.
    std::optional<Fields> fields = {};
    std::vector<Certificate> certificates = {};
    std::string why_no_certificate = {};  // one line, if one was wanted

    // Set if a program outside this process did the work: the time it reports, and its peak resident set.
    double reported_seconds = std::numeric_limits<double>::quiet_NaN();
    std::int64_t outside_bytes = -1;
};

// h(A,B), H(A,B), or the penetration depth of two solids (Tang et al. 2009, section 7.3): the largest H between the two halves
// of the boundary of a connected part of their common volume, one half from A and one from B. See composed/penetration/.
enum class Quantity { directed, symmetric, penetration };
inline constexpr Quantity quantities[] = {Quantity::directed, Quantity::symmetric, Quantity::penetration};
std::string_view to_string(Quantity quantity);

// "h(A,B)", "H(A,B)", "the penetration depth".
std::string_view symbol(Quantity quantity);

// Extra output that an answer should contain. Timed runs ask for none.
struct Wanted {
    bool fields = false;
    bool stages = false;  // seconds by stage in `reported`, such as "seconds: subdivide"
    bool certificate = false;
};
inline constexpr std::string_view stage_prefix = "seconds: ";

struct Query {
    Quantity quantity = Quantity::directed;
    Pose source_pose, target_pose;
    Tolerance tolerance;

    // Lengths at which a solver may stop early. "Is h above d?" is floor = cutoff = d; the tolerance then ends nothing. The
    // lower bound stays proven, with its witness: a solver never returns the floor as a bound.
    double floor = 0;                                             // may stop once upper <= floor
    double cutoff = std::numeric_limits<double>::infinity();      // may stop once lower > cutoff
    double time_limit = std::numeric_limits<double>::infinity();  // seconds of wall time
    std::uint64_t budget = std::numeric_limits<std::uint64_t>::max();
    int threads = 1;  // the most that may work; the interval must not depend on it
    Wanted wanted;

    // Returns the status with which a solver may stop at these bounds, or nothing if they are too far apart. Distances below
    // the floor do not matter, so the gap is upper - max(lower, floor).
    std::optional<Status> answer(double lower, double upper) const {
        if (lower > cutoff) return Status::above_cutoff;
        const bool asks = floor >= cutoff;
        if (upper <= floor && (floor > 0 || asks)) return Status::below_floor;
        if (!asks && upper - (lower > floor ? lower : floor) <= tolerance.gap(lower)) return Status::converged;
        return std::nullopt;
    }
};

// Properties shared by all later queries; lets a solver skip preparation that none of them needs.
struct QuerySet {
    bool moves = false;  // some pose of A is not the identity
    std::size_t count = 1;
    double finest_tolerance = 0;
    bool target_moves = false;   // some pose of B is not the identity
    bool target_copied = false;  // some answer needs a posed copy of B, see session/moving_target.h
    bool symmetric = false;      // some query asks for H(A,B)
    int threads = 1;             // the most that a query or the building of structures may use
};

// Data that a solver carries from one pose of a chain to the next, such as the last witness. It may speed up an answer but
// never changes the meaning of a bound. A later pose may be answered by another instance of the solver, prepared on the same
// shapes.
class State {
public:
    virtual ~State() = default;

    // Takes hints from the state of the other direction of H(A,B) at the same pose: pairs that were close there are close
    // here. Called for solvers with Ability::shared_pairs.
    virtual void learn_from(const State& /*opposite*/) {}
};

class Solver {
public:
    virtual ~Solver() = default;

    // Returns whether the bounds hold under rounding with the options given. Asked only if SolverInfo::certified is set, of a
    // solver made just for this question, so a constructor should only read options.
    virtual bool certified() const { return true; }

    // Returns the structures that this scene and these queries require. Keep it cheap.
    virtual Needs needs(const Scene&, const QuerySet&) const { return {}; }

    // Builds private data of the solver; timed separately from solve(). Both arguments outlive the last solve().
    virtual void prepare(const Scene& scene, const Prepared& prepared) = 0;

    // Returns the memory that prepare() allocated, in bytes; 0 if it is negligible.
    virtual std::size_t prepared_bytes() const { return 0; }

    // Returns the state for a new chain of nearby poses, for solvers with Ability::warm; null if every answer is cold.
    virtual std::unique_ptr<State> begin() const { return nullptr; }

    // Answers a query. Re-entrant: only `state` may change, which is null or comes from begin() and belongs to one chain of
    // queries, so the order of other queries cannot matter. Hard input never throws: return `stalled` with bounds that hold.
    virtual Result solve(const Query& query, State* state, Trace& trace) const = 0;
};

// Abilities beyond bounding h(A,B) for a moving source.
enum class Ability {
    traces,         // offers samples to Trace
    moving_target,  // honours Query::target_pose
    warm,           // makes use of a State
    shared_pairs,   // and of the State of the other direction, see State::learn_from
    threads,        // makes use of Query::threads
    fields,         // gives Result::fields if wanted
    certificates,   // gives Result::certificates if wanted and if time allows

    // The tolerance decides only when the solver stops, so its trace contains the answers to coarser tolerances,
    // bit for bit, and the harness reads them from there.
    coarser_answers,

    // Slightly wider bounds are acceptable: if the target is a mesh that moves rigidly, Session may move the
    // source the other way instead of building structures over a posed copy.
    undone_motion,
};
std::string_view to_string(Ability ability);

struct SolverInfo {
    std::string name;   // as in experiment files
    std::string title;  // as in tables and legends
    std::string paper;  // key in papers.bib; empty: our own, and the title ends with "(ours)"
    ShapeSet source, target;

    // The bounds hold under rounding; the solver's file derives the error. See Solver::certified.
    bool certified = false;

    // Describes a published error that is kept on purpose, so bounds may not hold. Excludes `certified`.
    std::string known_wrong = {};

    // The answer does not depend on the tolerance: the exact distance, or bounds of fixed width.
    bool ignores_tolerance = false;

    // Takes the scene unscaled. Meant for outside programs, to show their limits.
    bool original_coordinates = false;

    std::vector<Quantity> quantities = {Quantity::directed};
    std::set<Ability> abilities = {};
    Needs may_need = {};  // every structure that it can ever use
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

// Use it as SolverEntry::make if the solver is constructed from its options.
template <class AnySolver> std::unique_ptr<Solver> make_solver(const Options& options) {
    return std::make_unique<AnySolver>(options);
}

}  // namespace hausbench
