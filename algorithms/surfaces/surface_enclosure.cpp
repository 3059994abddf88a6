// Certified bounds for the distance between algebraic surfaces that close in as far as asked: this project's own.
//
// Lower bound: a point a of A is proven to exist (the polynomial changes its sign on a tiny segment in the box), and the
// boxes of an octree over B, each with a linear enclosure of its piece of B, are refined next to a until none can hold a
// point nearer than the bound. Upper bound: every point of A lies in a box of an octree over A; over the piece in such a
// box the distance to one proven point b of B is bounded from above, and no point of A is farther from B. Boxes whose upper
// bound is below the lower bound are dropped, that of the largest is split: refinement only where the answer is open.
// The maximum may lie where a box clips A: boxes and enclosures are of the clipped surface, so nothing is special there.
//
// Both bounds use that the piece in a box of size s lies within O(s^2) of a plane (surface_tree.h), so that the number of
// boxes of B does not grow as s shrinks. Where A and B are close, or run side by side, more bounds apply: surface_beside.h, and
// surface_feet.h, whose error is O(s^9). With it, boxes stay large where the distance is constant over A (concentric spheres).
//
// Surfaces are never empty (geometry.h); one that has no point in its box is refused when that is seen in preparing. Where no
// point can be proven (f = g^2 has no change of sign) bounds hold all the same, but do not close: `stalled`. So does a
// search that needs more than `most_cells` boxes, such as the lower bound at a point that is equally far from much of B.
//
// Proof of existence by a change of sign and linear enclosures by Taylor expansion are standard, see Neumaier: Interval
// methods for systems of equations, 1990; best-first refinement of A against candidates of B as in Tang, Lee, Kim 2009.
// Budget: boxes of A split. Time: boxes of A times boxes of B looked at, each O(terms of the polynomial).
#include "error.h"
#include "kernel/deadline.h"
#include "kernel/rounding.h"
#include "solver.h"
#include "surfaces/surface_beside.h"
#include "surfaces/surface_feet.h"

#include <algorithm>
#include <queue>

namespace hausbench {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int kept_feet = 3;
constexpr int unproven_at_most = 4000;  // boxes split, or points searched for, without a single proven point

Vec3 nowhere() { return Vec3::Constant(std::numeric_limits<double>::quiet_NaN()); }

class Search {
public:
    Search(const SurfaceTree& source, const SurfaceTree& target, std::size_t most_cells, const Query& query,
           Trace& trace)
        : a_(source), b_(target), most_cells_(most_cells), query_(query), trace_(trace), deadline_(query.time_limit) {
        result_.bounds = {0, fallback()};
    }

    Result run() {
        Cell root{fallback(), 0, {}, 0};
        queue_.push(root);
        result_.status = loop();
        if (const auto answer = query_.answer(result_.bounds.lower, result_.bounds.upper)) result_.status = *answer;
        return result_;
    }

private:
    struct Cell {
        double upper;
        std::int32_t node;  // of A
        std::array<std::int32_t, kept_feet> feet;
        int feet_count;
        bool operator<(const Cell& other) const {
            return upper < other.upper || (upper == other.upper && node > other.node);
        }
    };

    // The farthest any two points of the boxes can be from each other: an upper bound because B is not empty.
    double fallback() const {
        Interval sum(0.0);
        for (int k = 0; k < 3; ++k) {
            const Interval first = Interval(b_.box().high[k]) - Interval(a_.box().low[k]),
                           second = Interval(a_.box().high[k]) - Interval(b_.box().low[k]);
            sum += CGAL::square(Interval(std::max({first.sup(), second.sup(), 0.0})));
        }
        return CGAL::sqrt(sum).sup();
    }

    Status loop() {
        std::uint64_t splits = 0;
        while (!queue_.empty()) {
            const Cell top = queue_.top();
            Bounds& bounds = result_.bounds;
            bounds.upper = std::min(bounds.upper, std::max(top.upper, bounds.lower));
            trace_.record(bounds.lower, bounds.upper);
            if (const auto answer = query_.answer(bounds.lower, bounds.upper)) return *answer;
            if (splits >= query_.budget) return Status::budget;
            if (deadline_.passed()) return Status::time_limit;
            if (!proven_ && result_.counters.subdivisions > unproven_at_most) {
                result_.note =
                    "no point of the source could be proven to exist: its polynomial may not change its sign there";
                return Status::stalled;
            }
            if (feet_.empty() && result_.counters.closest_point_queries > unproven_at_most) {
                result_.note =
                    "no point of the target could be proven to exist: its polynomial may not change its sign there";
                return Status::stalled;
            }
            if (a_.size() + b_.size() > most_cells_) {
                result_.note = "more boxes are needed than 'most_cells' allows";
                return Status::stalled;
            }
            if (!a_.may_split(top.node)) {
                if (bounds.gap() <= 1e-9 * fallback()) return Status::precision_floor;
                result_.note =
                    "next to a point that is about equally far from much of the target: too many boxes there";
                return Status::stalled;
            }
            queue_.pop();
            a_.split(top.node, result_.counters);
            ++splits;
            ++result_.counters.subdivisions;
            const std::int32_t first = a_[top.node].first, count = a_[top.node].count;
            for (std::int32_t i = first; i < first + count; ++i) {
                Cell child = top;
                child.node = i;
                look_into(child);
                if (child.upper > result_.bounds.lower) queue_.push(child), ++result_.counters.queue_pushes;
            }
        }
        if (!proven_) {  // against the agreement that shapes are not empty
            result_.note = "the source has no point in its box";
            return Status::stalled;
        }
        result_.bounds.upper = result_.bounds.lower;
        return Status::converged;
    }

    // Bounds the cell, and updates the lower bound where a point in it is farther from B.
    void look_into(Cell& cell) {
        const SurfaceTree::Node piece = a_[cell.node];  // a copy: the tree grows
        ++result_.counters.bound_tests;
        for (int i = 0; i < cell.feet_count; ++i)
            cell.upper = std::min(cell.upper, to_foot(piece, cell.feet[std::size_t(i)]));
        if (cell.upper <= result_.bounds.lower) return;
        const double size = 2 * piece.form.half.norm();
        if (cell.upper < 8 * size || cell.upper < 1e-3 * a_.box().high.cwiseAbs().maxCoeff()) {
            cell.upper = std::min(cell.upper, next_to(piece, b_, result_.counters));
            if (cell.upper <= result_.bounds.lower) return;
        }
        const Vec3 guess = guess_on(piece, piece.form.middle);
        if (cell.feet_count > 0) {
            const Vec3& foot = feet_[std::size_t(cell.feet[0])].at;
            cell.upper = std::min(cell.upper, along_feet(piece, a_, b_, guess, foot, cell.upper, result_.counters));
            if (cell.upper <= result_.bounds.lower) return;
        }
        const auto point = a_.nearby(guess, guess, result_.counters);
        const Vec3 p = point ? point->at : guess;
        const double wanted = query_.tolerance.gap(std::max(result_.bounds.lower, 0.0));
        const double precision = std::max(wanted / 8, (cell.upper - result_.bounds.lower) / 16);
        std::int32_t foot = -1;
        const double near = nearest(p, cell, size, precision, foot);
        if (point && show(*point, near, foot) && foot >= 0) local_search(*point, foot, size, cell);
        if (foot >= 0) {
            cell.upper = std::min(cell.upper, to_foot(piece, foot));
            if (cell.upper > result_.bounds.lower) {
                cell.upper = std::min(cell.upper,
                                      beside(piece, b_, p, feet_[std::size_t(foot)].at, cell.upper, result_.counters));
            }
            remember(cell, foot);
        }
    }

    // Takes over a proven point of A at least `near` away from B, if that is more than is known.
    bool show(const SurfacePoint& point, double near, std::int32_t foot) {
        const double shown = -(point.error - near);  // rounded down
        const bool better = !proven_ || shown > result_.bounds.lower;
        proven_ = true;
        if (!better) return false;
        result_.bounds.lower = std::max(result_.bounds.lower, shown);
        result_.witness.source_point = point.at;
        result_.witness.target_point = foot >= 0 ? feet_[std::size_t(foot)].at : nowhere();
        return true;
    }

    // Increases the distance of a point of A: moves it away from its foot and back onto A, as long as that helps. The last
    // point is proven as any other. Only where it pays: the gap has halved since the last search, or it is the first.
    void local_search(SurfacePoint point, std::int32_t foot, double step, const Cell& cell) {
        const double gap = result_.bounds.gap();
        if (gap > 0.5 * searched_at_) return;
        searched_at_ = gap;
        const SurfacePoint start = point;
        SurfacePoint b = feet_[std::size_t(foot)];
        double height = (point.at - b.at).norm();
        for (int i = 0; i < 60 && step > 1e-15 * height; ++i) {
            const Vec3 away = (point.at - b.at) / height;
            const auto to = a_.nearby(point.at + step * away, point.at, result_.counters);
            const auto below = to ? b_.nearby(to->at, b.at, result_.counters) : std::nullopt;
            const double next = below ? (to->at - below->at).norm() : 0;
            if (next > height) {
                point = *to;
                b = *below;
                height = next;
                step *= 2;
            } else {
                step *= 0.25;
            }
        }
        if (point.at == start.at) return;
        std::int32_t found = -1;
        Cell at = cell;
        feet_.push_back(b);
        remember(at, static_cast<std::int32_t>(feet_.size()) - 1);
        const double near = nearest(point.at, at, infinity, query_.tolerance.gap(result_.bounds.lower) / 8, found);
        show(point, near, found);
    }

    // The foot goes first; the one used least recently falls out.
    static void remember(Cell& cell, std::int32_t foot) {
        auto* end = cell.feet.data() + cell.feet_count;
        auto* at = std::find(cell.feet.data(), end, foot);
        if (at == end) {
            if (cell.feet_count < kept_feet) ++cell.feet_count;
            at = cell.feet.data() + cell.feet_count - 1;
        }
        std::move_backward(cell.feet.data(), at, at + 1);
        cell.feet[0] = foot;
    }

    double to_foot(const SurfaceTree::Node& piece, std::int32_t foot) {
        ++result_.counters.box_distances;
        const SurfacePoint& b = feet_[std::size_t(foot)];
        return distance_at_most(piece, b.at) + b.error;
    }

    struct Near {
        double least;
        std::int32_t node;
        bool operator<(const Near& other) const {
            return least > other.least || (least == other.least && node > other.node);
        }
    };

    // At least the distance from p to B. `foot` becomes the nearest proven point found; the search ends when no point can
    // be nearer than that by more than `precision`, or when the cell is seen to be of no use.
    double nearest(const Vec3& p, const Cell& cell, double cell_size, double precision, std::int32_t& foot) {
        double best = infinity;  // at least the distance to the foot
        const auto try_foot = [&](std::int32_t i) {
            const double d = apart_at_most(p, feet_[std::size_t(i)].at) + feet_[std::size_t(i)].error;
            if (d < best) best = d, foot = i;
        };
        for (int i = 0; i < cell.feet_count; ++i) try_foot(cell.feet[std::size_t(i)]);
        const auto improve = [&](const Vec3& guess) {
            const auto found = b_.nearby(p, guess, result_.counters);
            if (!found) return;
            const double d = apart_at_most(p, found->at) + found->error;
            if (!(d < best)) return;
            feet_.push_back(*found);
            best = d;
            foot = static_cast<std::int32_t>(feet_.size()) - 1;
        };
        if (foot >= 0) improve(feet_[std::size_t(foot)].at);
        // The lower bound would hardly grow: that no point is nearer need not be shown.
        if (best <= result_.bounds.lower + 2 * precision) return 0;
        std::priority_queue<Near> queue;
        queue.push({0, 0});
        int pops = 0;
        while (!queue.empty()) {
            const Near top = queue.top();
            // Half of the precision is given away, so that whoever checks the bound needs no more boxes than we did.
            if (top.least >= best - precision) return std::max(std::min(top.least, best - 0.5 * precision), 0.0);
            // No point of A in this cell is farther from B than the answer: its lower bound is of no interest.
            if (best + cell_size <= result_.bounds.lower || !b_.may_split(top.node)) return top.least;
            if (++pops > (best == infinity ? 200 : 20000) || (pops % 64 == 0 && deadline_.passed())) return top.least;
            queue.pop();
            if (pops > 3) {
                const Vec3 guess = guess_on(b_[top.node], p);
                if (best == infinity || (guess - p).norm() < best - precision) improve(guess);
            }
            b_.split(top.node, result_.counters);
            const std::int32_t first = b_[top.node].first, count = b_[top.node].count;
            for (std::int32_t i = first; i < first + count; ++i) {
                ++result_.counters.box_distances;
                const double least = std::max(top.least, distance_at_least(b_[i], p));
                if (least < best) queue.push({least, i}), ++result_.counters.node_visits;
            }
        }
        return best == infinity ? 0 : std::max(best - 0.5 * precision, 0.0);
    }

    SurfaceTree a_, b_;
    std::size_t most_cells_;
    const Query& query_;
    Trace& trace_;
    Deadline deadline_;
    std::vector<SurfacePoint> feet_;  // proven points of B
    std::priority_queue<Cell> queue_;
    bool proven_ = false;            // some point of A
    double searched_at_ = infinity;  // the gap then
    Result result_;
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
        const UpwardRounding upward;
        return Search(*source_, *target_, most_cells_, query, trace).run();
    }

private:
    // To a depth at which most surfaces that are empty are seen to be.
    static SurfaceTree grown(const AlgebraicSurface& surface) {
        constexpr int depth = 4;
        SurfaceTree tree(surface);
        Counters ignored;
        std::vector<std::int32_t> level;
        if (tree.size() > 0) level.push_back(0);
        for (int d = 0; d < depth; ++d) {
            std::vector<std::int32_t> next;
            for (const std::int32_t i : level) {
                tree.split(i, ignored);
                for (std::int32_t c = tree[i].first; c < tree[i].first + tree[i].count; ++c) next.push_back(c);
            }
            level = std::move(next);
        }
        if (level.empty())
            throw InputError("surface '" + surface.polynomial +
                             "': has no point in its box: give another box or polynomial");
        return tree;
    }

    std::size_t most_cells_;
    std::optional<SurfaceTree> source_, target_;
};

}  // namespace

SolverEntry surface_enclosure_solver() {
    SolverInfo info;
    info.name = "surface_enclosure";
    info.title = "surface enclosure (ours)";
    info.source.surface = info.target.surface = true;
    info.certified = true;
    info.traces = true;
    info.parameters = {
        {.name = "most_cells",
         .default_value = std::int64_t{4000000},
         .unit = "boxes",
         .paper_value = "",
         .description = "in both trees together, of about 150 bytes each; beyond, the solver stalls",
         .choices = {},
         .least = 1000,
         .most = 1e9},
    };
    return {info, [](const Options& options) -> std::unique_ptr<Solver> {
                return std::make_unique<SurfaceEnclosure>(options);
            }};
}

}  // namespace hausbench
