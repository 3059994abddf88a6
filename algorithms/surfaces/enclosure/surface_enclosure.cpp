// Certified bounds on the distance between algebraic surfaces, to any tolerance (ours).
//
// A *piece* is the part of a surface in a box; a *proven point* is proven to lie on a surface up to a tiny error, by a
// change of sign of the polynomial on a tiny segment (surface_tree.h). Lower bound: the distance from a proven point a
// of A to B. The boxes of an octree over B are refined near a until none can contain a point nearer than the bound.
// Upper bound: every point of A lies in a box of an octree over A. For the piece in such a box, the distance to one
// proven point of B is bounded from above. Boxes whose upper bound is below the lower bound are dropped, and the box
// with the largest upper bound is split. The octree covers just the box that clips A, so a maximum at its sides is not
// a special case.
//
// Both bounds use the fact that the piece in a box of size s lies within O(s^2) of a plane, so the number of boxes of B
// does not grow as s shrinks. If A and B are close, or run side by side, there are more upper bounds: beside.h, and
// feet.h, whose error is O(s^9), so that boxes stay large if the distance is constant over A (concentric spheres).
//
// prepare() refuses a surface that is proven to have no point in its box. If no point can be proven (f = g^2 never
// changes sign), the bounds hold but do not approach each other: `stalled`. A search that needs more than `most_cells`
// boxes also stalls. This happens to the lower bound at a point that is about equally far from a large part of B.
//
// Proofs of existence by changes of sign and linear enclosures are standard, see Neumaier: Interval methods for systems
// of equations, 1990; best-first refinement of A against candidates of B is as in Tang, Lee, Kim 2009. Budget: boxes of
// A split. Time: boxes of A times boxes of B examined, each O(terms of the polynomial).
#include "algorithms/error.h"
#include "algorithms/kernel/deadline.h"
#include "algorithms/kernel/interval.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/solver.h"
#include "algorithms/surfaces/enclosure/beside.h"
#include "algorithms/surfaces/enclosure/feet.h"
#include "algorithms/surfaces/enclosure/proven_feet.h"

#include <algorithm>
#include <array>
#include <optional>
#include <queue>
#include <span>

namespace hausbench::surface_enclosure {

namespace {

constexpr int kept_feet = 3;
constexpr int unproven_at_most = 4000;  // limit on boxes split, or points searched for, while no point is proven

// The constants below, and in proven_feet.cpp, were chosen by trial. Each percentage says by how much the number of
// polynomial evaluations changes, at most, if a constant is halved or doubled: on average over 28 queries of 12 pairs
// of surfaces (surfaces_gallery and the cones, tolerances 1e-2 to 1e-6).

// next_to() (beside.h) is tried for a cell if its upper bound is less than near_sizes times the size of the cell (0.3
// %), or less than near_coordinates times the largest coordinate of A (0 %; this matters for even smaller cells).
constexpr double near_sizes = 8, near_coordinates = 1e-3;
// The distance from a point to B is computed with a precision of 1/8 of the tolerance (1 %) or 1/16 of the gap between
// the bounds (0.3 %), whichever is larger.
constexpr double parts_of_tolerance = 8, parts_of_gap = 16;
// A local search has at most most_search_steps steps (2 %). A success multiplies the step by longer_step, a failure by
// shorter_step (5 %). The search ends when the step is below least_step times the distance, a few ulps.
constexpr int most_search_steps = 60;
constexpr double longer_step = 2, shorter_step = 0.25, least_step = 1e-15;
// A new local search starts only if the gap between the bounds is at most this fraction of the gap at the last one.
// Half of this value saves 2 % of the work; without this limit, the work grows by 15 %.
constexpr double gap_of_next_search = 0.5;

Vec3 nowhere() { return Vec3::Constant(std::numeric_limits<double>::quiet_NaN()); }

// A box of A in the queue. No point of A in this box is farther from B than `upper`.
struct Cell {
    double upper;
    std::int32_t node;
    std::array<std::int32_t, kept_feet> feet;  // proven points of B near it, most recently used first
    int feet_count;

    bool operator<(const Cell& other) const {
        return upper < other.upper || (upper == other.upper && node > other.node);
    }

    std::span<const std::int32_t> known_feet() const { return {feet.data(), std::size_t(feet_count)}; }

    // Moves the foot to the front of the list, or inserts it there if it is new. Drops the least recently used foot if
    // the list is full.
    void remember(std::int32_t foot) {
        auto* end = feet.data() + feet_count;
        auto* at = std::find(feet.data(), end, foot);
        if (at == end) {
            if (feet_count < kept_feet) ++feet_count;
            at = feet.data() + feet_count - 1;
        }
        std::move_backward(feet.data(), at, at + 1);
        feet[0] = foot;
    }
};

class Search {
public:
    Search(const SurfaceTree& source, const SurfaceTree& target, std::size_t most_cells, const Query& query,
           Trace& trace)
        : most_cells_(most_cells),
          query_(query),
          trace_(trace),
          deadline_(query.deadline()),
          a_(source),
          feet_(target, deadline_, result_.counters) {
        result_.bounds = {0, farthest_corners()};
    }

    Result run() {
        queue_.push({farthest_corners(), 0, {}, 0});
        result_.status = refine();
        if (const auto answer = query_.answer(result_.bounds.lower, result_.bounds.upper)) result_.status = *answer;
        return result_;
    }

private:
    // Returns the largest distance between a point of A's box and a point of B's box. It is an upper bound on h(A,B),
    // because B is not empty.
    double farthest_corners() {
        const Box &a = a_.box(), &b = feet_.tree().box();
        Interval sum(0.0);
        for (int k = 0; k < 3; ++k) {
            const Interval first = Interval(b.high[k]) - Interval(a.low[k]),
                           second = Interval(a.high[k]) - Interval(b.low[k]);
            sum += CGAL::square(Interval(std::max({first.sup(), second.sup(), 0.0})));
        }
        return CGAL::sqrt(sum).sup();
    }

    Status refine() {
        std::uint64_t splits = 0;
        Bounds& bounds = result_.bounds;
        while (!queue_.empty()) {
            const Cell top = queue_.top();
            bounds.upper = std::min(bounds.upper, std::max(top.upper, bounds.lower));
            trace_.record(bounds.lower, bounds.upper);
            if (const auto answer = query_.answer(bounds.lower, bounds.upper)) return *answer;
            if (splits >= query_.budget) return Status::budget;
            if (deadline_.passed()) return Status::time_limit;
            if (const auto given_up = hopeless(top)) return *given_up;
            queue_.pop();
            ++splits;
            split(top);
        }
        // The queue is empty although no point of A was ever proven. If all boxes were empty, A has no point, which
        // breaks the rule that shapes are not empty. Otherwise B passes through all points that A may have.
        if (!proven_)
            return stalled(dropped_
                               ? "no point of the source could be proven to exist, though none is away from the target"
                               : "the source has no point in its box");
        bounds.upper = bounds.lower;
        return Status::converged;
    }

    Status stalled(const char* why) {
        result_.note = why;
        return Status::stalled;
    }

    // Returns a status if going on is useless, and sets the note to the reason.
    std::optional<Status> hopeless(const Cell& top) {
        if (!proven_ && result_.counters.subdivisions > unproven_at_most)
            return stalled("no point of the source could be proven to exist: its polynomial may not change sign there");
        if (feet_.empty() && result_.counters.closest_point_queries > unproven_at_most)
            return stalled("no point of the target could be proven to exist: its polynomial may not change sign there");
        if (a_.size() + feet_.tree().size() > most_cells_)
            return stalled("more boxes are needed than 'most_cells' allows");
        if (result_.bounds.gap() <= 8 * resolution()) {
            result_.note = "doubles are too far apart at these coordinates: move both surfaces towards the origin";
            return Status::precision_floor;
        }
        if (a_.may_split(top.node)) return std::nullopt;
        if (result_.bounds.gap() <= 1e-9 * farthest_corners()) return Status::precision_floor;
        return stalled("next to a point that is about equally far from much of the target: too many boxes there");
    }

    void split(const Cell& cell) {
        a_.split(cell.node, result_.counters);
        ++result_.counters.subdivisions;
        const std::int32_t first = a_[cell.node].first, count = a_[cell.node].count;
        for (std::int32_t i = first; i < first + count; ++i) {
            Cell child = cell;
            child.node = i;
            bound(child);
            if (child.upper > result_.bounds.lower) {
                queue_.push(child);
                ++result_.counters.queue_pushes;
            } else {
                dropped_ = true;
                if (WATCHED("surface_enclosure: a point of A is proven before all boxes are dropped", !proven_))
                    prove_point_near(child);
            }
        }
    }

    // Lowers the upper bound of a cell with methods of increasing cost, until it is at most the solver's lower bound:
    // the cell then cannot contain the farthest point. The last methods find a proven point in the cell, which may also
    // raise the lower bound.
    void bound(Cell& cell) {
        const SurfaceTree::Node piece = a_[cell.node];  // a copy: the tree grows
        ++result_.counters.bound_tests;
        const auto lowered = [&](double upper) {
            cell.upper = std::min(cell.upper, upper);
            return cell.upper <= result_.bounds.lower;
        };
        double to_feet = infinity;
        for (const std::int32_t foot : cell.known_feet()) to_feet = std::min(to_feet, feet_.at_most(piece, foot));
        if (lowered(to_feet)) return;
        const double size = 2 * piece.form.half.norm();
        if (may_run_beside(cell.upper, size) && lowered(next_to(piece, feet_.tree(), result_.counters))) return;
        const Vec3 seed = seed_on(piece, piece.form.middle);
        if (cell.feet_count > 0) {
            const Vec3& foot = feet_[cell.feet[0]].at;
            if (lowered(along_feet(piece, a_, feet_.tree(), seed, foot, cell.upper, result_.counters))) return;
        }
        const auto point = a_.nearby(seed, seed, result_.counters);
        const Vec3 p = point ? point->at : seed;
        const NearestFoot near = feet_.nearest(p, cell.known_feet(), {precision_of(cell), result_.bounds.lower, size});
        if (near.foot < 0) {
            if (point) show(*point, near);
            return;
        }
        if (point && show(*point, near)) local_search(*point, near.foot, size, cell);
        if (!lowered(feet_.at_most(piece, near.foot)))
            lowered(beside(piece, feet_.tree(), p, feet_[near.foot].at, cell.upper, result_.counters));
        cell.remember(near.foot);
    }

    // Proves a point of A near a cell, if it can. Without it, a search on two surfaces that coincide could drop all cells
    // before any point is proven.
    void prove_point_near(const Cell& cell) {
        const SurfaceTree::Node piece = a_[cell.node];
        const Vec3 seed = seed_on(piece, piece.form.middle);
        const auto point = a_.nearby(seed, seed, result_.counters);
        if (!point) return;
        const double size = 2 * piece.form.half.norm();
        show(*point, feet_.nearest(point->at, cell.known_feet(), {precision_of(cell), result_.bounds.lower, size}));
    }

    // Returns whether next_to() may give a better bound than the distance to a single proven point of B. It does not if
    // B is far away, compared with the size of the cell.
    bool may_run_beside(double upper, double size) const {
        return upper < near_sizes * size || upper < near_coordinates * a_.box().high.cwiseAbs().maxCoeff();
    }

    // Returns the finest useful precision: the error of proven points that rounding makes unavoidable (see
    // SurfaceTree::prove()).
    double resolution() const {
        const auto most = [](const Box& box) {
            return std::max(box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff());
        };
        return 0x1p-51 * std::max(most(a_.box()), most(feet_.tree().box()));
    }

    // Returns a useful precision for the distance from a point of this cell to B: coarse while the upper bound of the
    // cell is far above the lower bound, finer when the bounds are close.
    double precision_of(const Cell& cell) const {
        const double wanted = query_.tolerance.gap(std::max(result_.bounds.lower, 0.0));
        return std::max(
            {wanted / parts_of_tolerance, (cell.upper - result_.bounds.lower) / parts_of_gap, resolution()});
    }

    // Makes a proven point of A the witness if it raises the lower bound, or if no point was proven before. Raises the
    // lower bound to the proven distance from this point to B, if that is larger. Returns whether the point became the
    // witness.
    bool show(const SurfacePoint& point, const NearestFoot& near) {
        const double shown = -(WATCHED("surface_enclosure: how far a proven point of A may be off", point.error) -
                               near.at_least);  // rounded down
        const bool better = !proven_ || shown > result_.bounds.lower;
        proven_ = true;
        if (!better) return false;
        result_.bounds.lower = std::max(result_.bounds.lower, shown);
        result_.witness.source_point = point.at;
        result_.witness.target_point = near.foot >= 0 ? feet_[near.foot].at : nowhere();
        return true;
    }

    // Searches for a point of A farther from B: moves `point` away from its closest point of B and back to A, as long
    // as the distance to B grows. Then proves a lower bound on this distance. Does nothing if the gap between the
    // bounds has not halved since the last search.
    void local_search(SurfacePoint point, std::int32_t foot, double step, Cell cell) {
        const double gap = result_.bounds.gap();
        if (gap > gap_of_next_search * searched_at_) return;
        searched_at_ = gap;
        const SurfacePoint start = point;
        SurfacePoint b = feet_[foot];
        double distance = (point.at - b.at).norm();
        for (int i = 0; i < most_search_steps && step > least_step * distance; ++i) {
            const Vec3 away = (point.at - b.at) / distance;
            const auto to = a_.nearby(point.at + step * away, point.at, result_.counters);
            const auto below = to ? feet_.tree().nearby(to->at, b.at, result_.counters) : std::nullopt;
            const double next = below ? (to->at - below->at).norm() : 0;
            if (next > distance) {
                point = *to;
                b = *below;
                distance = next;
                step *= longer_step;
            } else {
                step *= shorter_step;
            }
        }
        if (point.at == start.at) return;
        cell.remember(feet_.add(b));
        const double precision = query_.tolerance.gap(result_.bounds.lower) / parts_of_tolerance;
        show(point, feet_.nearest(point.at, cell.known_feet(), {precision, result_.bounds.lower, infinity}));
    }

    std::size_t most_cells_;
    const Query& query_;
    Trace& trace_;
    Deadline deadline_;
    Result result_;
    SurfaceTree a_;
    ProvenFeet feet_;
    std::priority_queue<Cell> queue_;
    bool proven_ = false;            // whether some point of A was proven
    bool dropped_ = false;           // whether a cell was dropped because B is near, not because it is empty
    double searched_at_ = infinity;  // the gap at the last local search
};

class SurfaceEnclosure final : public Solver {
public:
    explicit SurfaceEnclosure(const Options& options)
        : most_cells_(static_cast<std::size_t>(options.integer("most_cells"))) {}

    void prepare(const Scene& scene, const Prepared&) override {
        const UpwardRounding upward;
        source_.emplace(grown(surface_of(scene.source)));
        target_.emplace(grown(surface_of(scene.target)));
    }

    std::size_t prepared_bytes() const override {
        return (source_->size() + target_->size()) * sizeof(SurfaceTree::Node);
    }

    Result solve(const Query& query, State*, Trace& trace) const override {
        std::optional<UpwardRounding> upward;
        if (WATCHED("surface_enclosure: solve() sets the rounding mode itself", true)) upward.emplace();
        return Search(*source_, *target_, most_cells_, query, trace).run();
    }

private:
    // Returns the octree of a surface, refined enough to detect most empty surfaces. Throws InputError if the surface
    // is proven to be empty.
    static SurfaceTree grown(const AlgebraicSurface& surface) {
        constexpr int depth = 4;
        SurfaceTree tree(surface);
        Counters ignored;
        bool empty = true;
        for (std::int32_t i = 0; i < static_cast<std::int32_t>(tree.size()); ++i) {
            if (tree[i].depth < depth && tree.may_split(i))
                tree.split(i, ignored);
            else
                empty = false;
        }
        if (empty)
            throw InputError("surface '" + surface.polynomial +
                             "': has no point in its box: give another box or polynomial");
        return tree;
    }

    std::size_t most_cells_;
    std::optional<SurfaceTree> source_, target_;
};

}  // namespace

SolverEntry solver() {
    SolverInfo info;
    info.name = "surface_enclosure";
    info.title = "surface enclosure (ours)";
    info.source.surface = info.target.surface = true;
    info.certified = true;
    info.abilities.insert({Ability::traces, Ability::coarser_answers});
    info.parameters = {
        {.name = "most_cells",
         .default_value = std::int64_t{4000000},
         .unit = "boxes",
         .description =
             "most boxes in both trees together, of about 150 bytes each; the solver stalls if it needs more",
         .least = 1000,
         .most = 1e9},
    };
    return {info, make_solver<SurfaceEnclosure>};
}

}  // namespace hausbench::surface_enclosure
