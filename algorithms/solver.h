// The interface of all solvers. A solver bounds the directed Hausdorff distance
//
//     h(A,B) = max over a in A of min over b in B of |a - b|
//
// from below and above. A is the source and B the target. Each query moves both by its poses; "A posed" means A after
// this motion. One solver is one .cpp file without a header, with a namespace of its own, hausbench::NAME. It defines a
// class derived from Solver and a function solver(), which returns the solver's SolverEntry; a line in the CMakeLists.txt
// of its folder registers it. The shortest example is points/naive.cpp; read it next.
//
// Callers use a solver through a Session (session/session.h), which builds the structures, checks every status, and
// emulates unsupported features: it obtains H(A,B) = max(h(A,B), h(B,A)) from two directed answers, and answers for a
// moving target with a posed copy of B.
//
// A solver must honour `source_pose` and `tolerance` of a query, and `target_pose`, `quantity` and `wanted` as far as
// its SolverInfo offers them. All other fields of a query are optional hints.
//
// A solver may rely on the following. Shapes are not empty, and all coordinates are finite. Session scales both shapes
// by one power of two, so that the largest |coordinate| before posing is in [0.5, 1) or everything is 0. All lengths in
// the solver's queries and results are in this unit. Two kinds of scenes are not scaled: a scene with an algebraic
// surface, and a scene for a solver that asks for `original_coordinates`.
#pragma once

#include "algorithms/kernel/counters.h"
#include "algorithms/kernel/deadline.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/options.h"
#include "algorithms/prepared.h"
#include "algorithms/scene.h"
#include "algorithms/statistic.h"
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

// The kinds of shapes that a solver accepts as its source, or as its target.
struct ShapeSet {
    bool points = false, mesh = false, surface = false;
    bool contains(ShapeKind kind) const {
        return kind == ShapeKind::points ? points : kind == ShapeKind::mesh ? mesh : surface;
    }
};

// The largest gap between upper and lower bound at which an answer counts as converged.
struct Tolerance {
    // absolute: `value` is a length.
    // lower: `value` is a fraction of the lower bound. If the distance is 0, an answer then converges only when its
    // upper bound is exactly 0.
    enum class Of { absolute, lower };
    Of of = Of::absolute;
    double value = 0;

    // Returns the largest gap allowed, as a length, given the lower bound so far.
    double gap(double lower) const { return of == Of::absolute ? value : value * lower; }
};

// The reason why a solver stopped. The bounds are valid whatever the status.
enum class Status {
    converged,     // the gap, upper - max(lower, floor), is within the tolerance
    below_floor,   // upper <= floor
    above_cutoff,  // lower > cutoff
    time_limit,
    // The work allowed by Query::budget is done. The unit of work is a subdivision, unless the comment at the top of
    // the solver's file names another one.
    budget,
    precision_floor,  // rounding errors alone keep the gap above the tolerance
    stalled,          // the solver cannot go on for another reason
};
std::string_view to_string(Status status);

// Bounds on a distance: lower <= distance <= upper. The defaults are valid for every distance.
struct Bounds {
    double lower = 0;
    double upper = std::numeric_limits<double>::infinity();

    double gap() const { return upper - lower; }
};

// The pair of points that attains the lower bound, up to rounding: a point of one shape that is far from the other
// shape, and the closest point of the other shape. source_point lies on A and target_point on B, both after their
// motion. The far one is source_point for source_to_target, h(A,B), and target_point for target_to_source, h(B,A).
struct Witness {
    enum class Direction { source_to_target, target_to_source };
    // NaN if unknown.
    Vec3 source_point = Vec3::Constant(std::numeric_limits<double>::quiet_NaN()), target_point = source_point;
    // The index of the point or triangle on which each point lies; -1 if unknown.
    Index source_element = -1, target_element = -1;
    Direction direction = Direction::source_to_target;
};
std::string_view to_string(Witness::Direction direction);

// Facts that a solver reports about its run, by name. Each is a number, such as the share of points that were culled,
// or a text, such as the chosen algorithm. A number whose name begins with `length_prefix` is a length. Session scales
// it back to the unit of the input, which rounds it, so it is not a bound.
inline constexpr std::string_view length_prefix = "length: ";
using Reported = std::map<std::string, std::variant<double, std::string>>;

// One value for each vertex or each element (point or triangle) of A, such as the upper bound of each triangle.
struct Field {
    // `pieces` are parts into which triangles are cut to draw pictures. Only as_fields() (harness/ask/fields.h)
    // makes fields of pieces; solvers do not.
    enum class Of { vertices, elements, pieces };
    // `lower` and `upper` are bounds on distances, with the unit of a length. `number` has no unit.
    enum class Meaning { lower, upper, number };
    std::string name;
    Of of = Of::elements;
    Meaning meaning = Meaning::number;
    std::vector<double> values;
};
using Fields = std::vector<Field>;

// A proof of the upper bound `proven` that can be checked without the solver. `bytes` holds the proof, in the format
// named by `format`. It contains no lengths, so it stays valid when Session scales `proven` back to the unit of the
// input.
struct Certificate {
    std::string format;
    Witness::Direction direction = Witness::Direction::source_to_target;  // target_to_source: proves h(B,A)
    double proven = std::numeric_limits<double>::infinity();
    std::string bytes;
};

struct Result {
    Status status = Status::stalled;
    Bounds bounds;  // of the quantity that the query asks for, whatever the status
    // For Quantity::distribution: bounds of each statistic of the query. Session copies the first of them to `bounds`.
    std::vector<Bounds> statistics = {};
    Witness witness;
    Counters counters;
    Reported reported = {};

    // One line with the reason for a status other than `converged`, such as an error of an outside program. Empty if
    // the status says enough.
    std::string note = {};

    // Extra output that the query asked for (Query::wanted). H(A,B) has two certificates, one for each direction, or
    // none.
    std::optional<Fields> fields = {};
    std::vector<Certificate> certificates = {};
    std::string why_no_certificate = {};  // one line, if a certificate was wanted and there is none

    // Set only if an outside program did the work: the seconds that it reports (otherwise NaN), and its peak resident
    // memory in bytes (otherwise -1).
    double reported_seconds = std::numeric_limits<double>::quiet_NaN();
    std::int64_t outside_bytes = -1;
};

// The quantity to compute. `directed` is h(A,B), and `symmetric` is H(A,B) = max(h(A,B), h(B,A)).
// `penetration` is the penetration depth of two solids (Tang et al. 2009, section 7.3; composed/penetration/). The
// boundary of each connected part of their common volume consists of a part of A's surface and a part of B's surface.
// The depth is the largest H between these two, over all connected parts. `distribution` is a list of statistics of the
// distance (statistic.h), such as its mean.
enum class Quantity { directed, symmetric, penetration, distribution };
inline constexpr Quantity quantities[] = {Quantity::directed, Quantity::symmetric, Quantity::penetration,
                                          Quantity::distribution};
std::string_view to_string(Quantity quantity);

// Returns the quantity as messages show it: "h(A,B)", "H(A,B)", "the penetration depth" or "statistics of the distance".
std::string_view symbol(Quantity quantity);

// Extra output that an answer should contain. Timed runs ask for none.
struct Wanted {
    bool fields = false;       // Result::fields
    bool stages = false;       // seconds spent in each stage, in Result::reported, such as "seconds: subdivide"
    bool certificate = false;  // Result::certificates
};
inline constexpr std::string_view stage_prefix = "seconds: ";

// One question to a solver. The answer is a Result.
struct Query {
    Quantity quantity = Quantity::directed;
    Pose source_pose, target_pose;
    Tolerance tolerance;

    // Lengths at which a solver may stop early, whatever the tolerance. To ask "is the distance above d?", set both to
    // d; the tolerance is then ignored. The returned lower bound is never just the floor: it is proven and has a
    // witness.
    double floor = 0;                                                  // may stop once upper <= floor
    double cutoff = std::numeric_limits<double>::infinity();           // may stop once lower > cutoff
    double time_limit = std::numeric_limits<double>::infinity();       // seconds of wall time
    std::uint64_t budget = std::numeric_limits<std::uint64_t>::max();  // most units of work, see Status::budget
    int threads = 1;  // most threads to use; the bounds must not depend on the number
    Wanted wanted;
    const Interrupt* interrupt = nullptr;  // ends the solve early, as the time limit does; null: none

    // For Quantity::distribution. `floor` and `cutoff` are then ignored, and the tolerance holds for each statistic but
    // shares, which have a tolerance of their own.
    std::vector<Statistic> statistics = {};
    WeighBy weigh = WeighBy::area;
    double share_tolerance = 1e-3;

    // Returns a deadline that begins now and passes at the time limit, or when the interrupt asks to stop.
    Deadline deadline() const { return Deadline(time_limit, interrupt); }

    // Returns the largest gap allowed for a statistic, given its lower bound so far.
    double allowed_gap(const Statistic& statistic, double lower) const {
        return is_share(statistic) ? share_tolerance : tolerance.gap(lower);
    }

    // Returns whether these bounds, one for each statistic, are all within the tolerance.
    bool within_tolerance(const std::vector<Bounds>& bounds) const {
        if (bounds.size() != statistics.size()) return false;
        for (std::size_t i = 0; i < bounds.size(); ++i)
            if (!(0 <= bounds[i].lower && bounds[i].lower <= bounds[i].upper &&
                  bounds[i].gap() <= allowed_gap(statistics[i], bounds[i].lower)))
                return false;
        return true;
    }

    // Returns whether the query only asks if the distance is above the cutoff.
    bool is_question() const { return floor >= cutoff; }

    // Returns the status with which a solver may stop at these bounds. Returns nothing if they are too far apart.
    // Distances below the floor do not matter to the caller, so the gap is upper - max(lower, floor).
    std::optional<Status> answer(double lower, double upper) const {
        if (lower > cutoff) return Status::above_cutoff;
        if (upper <= floor &&
            WATCHED_ELSE("query: below the floor where none is given", floor > 0 || is_question(), true))
            return Status::below_floor;
        if (WATCHED_ELSE("query: the tolerance ends no question", !is_question(), true) &&
            upper - WATCHED_ELSE("query: what is below the floor does not count", lower > floor ? lower : floor,
                                 lower) <=
                tolerance.gap(lower))
            return Status::converged;
        return std::nullopt;
    }
};

// Properties of all later queries. They let a solver skip preparation that no query needs.
struct QuerySet {
    bool moves = false;     // some pose of A is not the identity
    std::size_t count = 1;  // number of queries
    // The smallest absolute tolerance of any query, in the unit of the input even if the scene is scaled. 0: unknown,
    // or the tolerance is a fraction of the lower bound.
    double finest_tolerance = 0;
    bool target_moves = false;   // some pose of B is not the identity
    bool target_copied = false;  // some answer needs a posed copy of B, see session/moving_target.h
    bool symmetric = false;      // some query asks for H(A,B)
    bool both_ways = false;      // some query asks for statistics of the distance from B to A
    int threads = 1;             // most threads for a query, and for building structures
};

// Data that a solver keeps between queries about nearby poses, called a chain of queries; for example, the last witness
// is a good first guess for the next pose. A State may speed up an answer, but bounds are valid whatever it contains.
// The next query may go to another solver instance for the same shapes, so a State must not refer to the instance that
// made it.
class State {
public:
    virtual ~State() = default;

    // Takes hints from the opposite direction of H(A,B) at the same pose: points of A and B that were close in that
    // direction are close in this one. Called only for solvers with Ability::shared_pairs.
    virtual void learn_from(const State& /*opposite*/) {}
};

// Base class of all solvers. An instance is made for one pair of shapes: the constructor reads the options, prepare()
// is called once, then solve() any number of times.
class Solver {
public:
    virtual ~Solver() = default;

    // Returns whether the bounds are valid despite rounding errors, with the options of this instance. Called only if
    // SolverInfo::certified is set. The harness makes an instance for this call alone, so the constructor should only
    // read options.
    virtual bool certified() const { return true; }

    // Returns the structures that this scene and these queries require. Keep it cheap.
    virtual Needs needs(const Scene&, const QuerySet&) const { return {}; }

    // Builds private data of the solver; timed separately from solve(). Both arguments outlive the last solve().
    virtual void prepare(const Scene& scene, const Prepared& prepared) = 0;

    // Returns the memory that prepare() allocated, in bytes; 0 if it is negligible.
    virtual std::size_t prepared_bytes() const { return 0; }

    // Returns the State for a new chain of queries. Returns null if the solver lacks Ability::warm.
    virtual std::unique_ptr<State> begin() const { return nullptr; }

    // Answers a query. Several threads may call it at the same time, so it may change only `state`, `trace` and local
    // variables. `state` is null or comes from begin(); each chain of queries has its own, and chains must not affect
    // each other. If the input is too hard, do not throw: return Status::stalled with valid bounds.
    virtual Result solve(const Query& query, State* state, Trace& trace) const = 0;
};

// Optional abilities of a solver, beyond answers for a moving source and a fixed target.
enum class Ability {
    traces,         // offers its bounds to Trace::record() while it runs
    moving_target,  // honours Query::target_pose
    warm,           // makes use of a State
    shared_pairs,   // also uses the State of the other direction of H(A,B), see State::learn_from
    threads,        // makes use of Query::threads
    fields,         // gives Result::fields if wanted
    certificates,   // gives Result::certificates if wanted and if time allows

    // The tolerance affects only when the solver stops. So the trace of a run with a fine tolerance contains the
    // answers to coarser ones, bit for bit, and the harness need not solve again for these.
    coarser_answers,

    // The solver permits slightly wider bounds if both shapes are meshes and the target moves rigidly. Session may then
    // move the source the opposite way instead, and need not build structures over a moved copy of the target.
    undone_motion,
};
std::string_view to_string(Ability ability);

// Declares a solver: its names, the scenes and queries that it accepts, and its parameters. The declaration is the same
// for all values of the parameters.
struct SolverInfo {
    std::string name;   // as in experiment files
    std::string title;  // as in tables and legends
    std::string paper;  // key in papers.bib; empty: our own, and the title ends with "(ours)"
    ShapeSet source, target;

    // The bounds are valid despite rounding errors; the solver's file derives the error. Solver::certified() may
    // withdraw this for some values of the parameters.
    bool certified = false;

    // An error of the paper that the solver reproduces on purpose, so that bounds may be wrong; empty if there is none.
    // A solver with such an error cannot be `certified`.
    std::string known_wrong = {};

    // The answer does not depend on the tolerance, because it is the exact distance or has bounds of fixed width.
    bool ignores_tolerance = false;

    // The solver receives the scene as loaded, without scaling. Meant for libraries and programs by others, to show
    // their limits.
    bool original_coordinates = false;

    std::vector<Quantity> quantities = {Quantity::directed};
    std::set<Ability> abilities = {};
    Needs may_need = {};  // every structure that needs() may ever return
    std::vector<ParameterSpec> parameters = {};

    bool offers(Quantity quantity) const {
        return std::find(quantities.begin(), quantities.end(), quantity) != quantities.end();
    }
    bool can(Ability ability) const { return abilities.contains(ability); }

    // The type of flags that plug-ins of interface 10 and earlier set to true. Setting one does not compile, and the error
    // says what to write.
    struct NowAnAbility {
        template <class T> void operator=(T) const {
            static_assert(sizeof(T) == 0,
                          "since plug-in interface 11 this is an ability: info.abilities = "
                          "{Ability::traces, ...}; see CHANGELOG.md, \"For plug-ins\"");
        }
    };
    static constexpr NowAnAbility traces{}, tolerance_guides{}, moving_target{}, undoes_target_motion{}, warm{},
        shares_pairs{}, threads{}, fields{}, certificates{};
};

// A registered solver: its declaration, and the function that makes an instance. `make` must read every parameter,
// throw only InputError, and not return null (contract.h).
struct SolverEntry {
    SolverInfo info;
    std::unique_ptr<Solver> (*make)(const Options&);
};

// A ready-made SolverEntry::make for a solver whose constructor takes only the options: {info, make_solver<MySolver>}.
template <class AnySolver> std::unique_ptr<Solver> make_solver(const Options& options) {
    return std::make_unique<AnySolver>(options);
}

}  // namespace hausbench
