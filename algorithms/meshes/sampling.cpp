// Sampling like Metro (Cignoni, Rocchini, Scopigno 1998) and MESH (Aspert, Santa-Cruz, Ebrahimi 2002): measures the
// distance to B from the vertices of A and from evenly spread points on its edges and faces. Neither paper was at
// hand, so this follows descriptions. Both programs report the largest distance of a sample, which is a lower bound on
// h(A,B). The upper bound is ours.
//
// Samples: each triangle of A gets a grid whose points divide every edge into n steps (kernel/rounding.h). L is the
// length of the longest edge, and n is the least number for which L / n is at most `step` times the diagonal of A's
// box. Thin triangles get more samples than in Metro and MESH, other triangles about as many.
//
// Upper bound of a triangle: the largest distance of its samples to B, plus the covering radius r = L / (n * sqrt(3)).
// Every point of the triangle is within r of a sample; kernel/rounding.h derives r and its rounding. So the gap is at
// most the largest r, which is below 0.58 * `step` diagonals, plus rounding. The tolerance does not change it: if the
// gap exceeds the tolerance, the status is `budget`. If `step` is halved so that every n doubles, the old samples
// remain, so the lower bound does not decrease, and the largest r is halved. The upper bound may increase: a new sample
// may be farther from B than its neighbours by up to 0.5 * L / n, while r decreases only by 0.29 * L / n.
//
// Order: first all vertices, then the other samples triangle by triangle, on the edges and inside. The vertices alone
// are a grid with n = 1. The bound from this grid is used if it is smaller than the bound from all samples, or if the
// search stops before it reaches the triangle. If it is at most Query::floor, the triangle is not sampled. An edge that
// two triangles share with the same n is measured once.
//
// Fields: as in guthe.cpp, but with the number n of "steps" instead of the "level".
//
// Budget: samples other than the vertices of A, which are always measured. Time: logarithmic in the size of B for each
// sample, on well-behaved data. Memory: proportional to the size of A and B; only samples at vertices and the farthest
// sample of each edge are stored.
#include "algorithms/kernel/deadline.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/search/bounds.h"
#include "algorithms/search/element_bounds.h"
#include "algorithms/search/mesh_solver.h"
#include "algorithms/search/source_vertices.h"
#include "algorithms/search/stages.h"
#include "algorithms/structures/octree.h"

#include <algorithm>
#include <array>
#include <optional>
#include <unordered_map>
#include <vector>

namespace hausbench::sampling {
namespace {

constexpr std::int64_t most_steps = std::int64_t{1} << 30;  // per edge; an int and a double hold it exactly

// The samples of an edge, without its ends.
struct EdgeSamples {
    std::int64_t steps = 0;  // the number of steps when the edge was last sampled; 0: not yet
    MeasuredPoint farthest{Vec3::Zero()};
};

// The sampling of one query.
class Sampling {
public:
    Sampling(const MeshPair& pair, const Query& query, Trace& trace, double step)
        : a_(pair.source),
          points_(pair.points),
          query_(query),
          rounding_{pair.magnitude},
          trace_(trace),
          step_(step),
          elements_(query.wanted.fields ? std::make_optional<ElementBounds>(a_.triangles.rows()) : std::nullopt),
          stages_(query.wanted.stages),
          bounds_(query, pair.target, rounding_, counters_, trace, elements_ ? &*elements_ : nullptr),
          vertices_(a_, points_, pair.target, nullptr, 0, bounds_, counters_) {}

    Result run() {
        Result result = sample();
        if (elements_) {
            result.fields = bounds_.fields();
            result.fields->back().name = "steps";
        }
        result.reported = stages_.seconds();
        return result;
    }

private:
    Result sample();
    void bound_by_corners();
    std::optional<Status> end(double rest);
    double squared_longest_edge(Index i) const;
    std::int64_t steps_of(double squared_edge) const;
    double corners_at_most(Index i) const;
    void settle(double upper, Index i) { bounds_.settle(upper, i, 0, 0); }
    bool sample_triangle(Index i, std::int64_t n, double by_corners);
    bool measure(const Vec3& point, Index i, MeasuredPoint& farthest);
    bool sample_edge(Index from, Index to, Index i, std::int64_t n, MeasuredPoint& farthest);
    bool sample_inside(Index i, std::int64_t n, MeasuredPoint& farthest);

    const TriangleMesh& a_;
    const Points& points_;
    const Query& query_;
    SurfaceRounding rounding_;
    Trace& trace_;
    double step_;  // a length
    Counters counters_;
    std::optional<ElementBounds> elements_;  // set only if fields are wanted
    Stages stages_;
    SearchBounds bounds_;
    SourceVertices vertices_;
    std::vector<double> rest_;  // entry i: the largest upper bound of triangles i and later, from vertices alone
    std::unordered_map<std::uint64_t, EdgeSamples> edges_;  // the key has the indices of both ends
    std::uint64_t samples_ = 0;                             // number of samples, without the vertices of A
    Index near_ = -1;  // where the next query starts: the triangle of B nearest to a neighbouring sample
    std::optional<Status> stopped_;
};

double Sampling::squared_longest_edge(Index i) const {
    const auto v = a_.triangles.row(i);
    const auto squared = [&](Index p, Index q) { return squared_length(Vec3(points_.row(q) - points_.row(p))); };
    return std::max(
        {squared(v[0], v[1]), squared(v[1], v[2]), WATCHED("sampling: the third edge counts", squared(v[2], v[0]))});
}

std::int64_t Sampling::steps_of(double squared_edge) const {
    const double edge = std::sqrt(squared_edge);
    if (!(edge > step_)) return 1;
    const double steps = std::ceil(edge / step_);
    return steps < static_cast<double>(most_steps) ? static_cast<std::int64_t>(steps) : most_steps;
}

double Sampling::corners_at_most(Index i) const {
    double most = 0;
    for (const MeasuredPoint& corner : vertices_.corners(i)) most = std::max(most, corner.squared);
    return WATCHED_ELSE("sampling: the rounding at corners", rounding_.at_most(most, 0), std::sqrt(most));
}

void Sampling::bound_by_corners() {
    const auto count = static_cast<std::size_t>(a_.triangles.rows());
    rest_.assign(count + 1, 0);
    for (std::size_t i = count; i-- > 0;) {
        const Index triangle = static_cast<Index>(i);
        const double upper =
            WATCHED_ELSE("sampling: a stop keeps the radius of the corners",
                         grid_distance_at_most(corners_at_most(triangle), squared_longest_edge(triangle), 1),
                         corners_at_most(triangle));
        ++counters_.bound_tests;
        rest_[i] = std::max(rest_[i + 1], upper);
    }
}

// Returns a status if the search may stop because of the floor or the cutoff, and nothing otherwise. `rest` is an upper
// bound for the triangles that are not sampled yet. The tolerance never stops the search, so every tolerance gets the
// same samples.
std::optional<Status> Sampling::end(double rest) {
    const double high = std::max(bounds_.settled(), rest);
    if (trace_.on()) trace_.record(bounds_.certified_lower(), high);
    bounds_.show(high);
    Query query = query_;
    query.tolerance = {Tolerance::Of::absolute, 0};
    if (!query.answer(std::sqrt(bounds_.farthest().point.squared), high)) return std::nullopt;
    return query.answer(bounds_.certified_lower(), high);
}

// Measures the distance of a sample to B. Sets `farthest` to the sample if it is farther from B than `farthest` was.
// Returns false if the budget or the time is spent.
bool Sampling::measure(const Vec3& point, Index i, MeasuredPoint& farthest) {
    if (samples_ >= query_.budget) stopped_ = Status::budget;
    if (samples_ % 64 == 0 && bounds_.out_of_time()) stopped_ = Status::time_limit;
    if (stopped_) return false;
    ++samples_;
    const MeasuredPoint measured = bounds_.measure(
        point, near_, i, WATCHED("sampling: the lower bound counts the rounding of samples", level_of_grid_point));
    near_ = measured.triangle;
    if (measured.squared > farthest.squared) farthest = measured;
    return true;
}

bool Sampling::sample_edge(Index from, Index to, Index i, std::int64_t n, MeasuredPoint& farthest) {
    if (from > to) std::swap(from, to);
    EdgeSamples& edge = edges_[(static_cast<std::uint64_t>(from) << 32) | static_cast<std::uint64_t>(to)];
    if (WATCHED_ELSE("sampling: an edge is measured anew for another number of steps", edge.steps != n,
                     edge.steps == 0)) {
        edge = {};
        const Vec3 a = points_.row(from), b = points_.row(to);
        for (std::int64_t k = 1; k < n; ++k) {
            if (!measure(grid_point(a, b, b, n - k, k, n), i, edge.farthest)) return false;
        }
        edge.steps = n;
    }
    bounds_.offer(edge.farthest, i, level_of_grid_point);
    if (WATCHED("sampling: the samples on edges count", edge.farthest.squared > farthest.squared))
        farthest = edge.farthest;
    return true;
}

bool Sampling::sample_inside(Index i, std::int64_t n, MeasuredPoint& farthest) {
    const auto v = a_.triangles.row(i);
    const Vec3 a = points_.row(v[0]), b = points_.row(v[1]), c = points_.row(v[2]);
    for (std::int64_t j = 1; j < n - 1; ++j) {
        Index first = near_;
        for (std::int64_t k = 1; k < n - j; ++k) {
            if (!measure(grid_point(a, b, c, j, k, n), i, farthest)) return false;
            if (k == 1) first = near_;
        }
        near_ = first;  // the next row starts next to the first sample of this row
    }
    return true;
}

// Samples a triangle and records its upper bound, which is at most `by_corners`, the bound from its vertices alone.
// Returns false, without recording a bound, if the budget or the time was spent.
bool Sampling::sample_triangle(Index i, std::int64_t n, double by_corners) {
    const auto v = a_.triangles.row(i);
    const auto corners = vertices_.corners(i);
    MeasuredPoint farthest{Vec3::Zero()};
    for (int k = 0; k < 3 && n > 1; ++k) {
        near_ = corners[static_cast<std::size_t>(k)].triangle;
        if (!sample_edge(v[k], v[(k + 1) % 3], i, n, farthest)) return false;
    }
    near_ = corners[2].triangle;
    if (WATCHED("sampling: the samples inside are taken", !sample_inside(i, n, farthest))) return false;
    double most = corners_at_most(i);
    if (farthest.triangle >= 0)
        most = std::max(most, rounding_.at_most(farthest.squared,
                                                WATCHED("sampling: the upper bound counts the rounding of samples",
                                                        level_of_grid_point)));
    ++counters_.bound_tests;
    settle(std::min(by_corners, WATCHED_ELSE("sampling: a triangle is widened by its radius",
                                             grid_distance_at_most(most, squared_longest_edge(i), n), most)),
           i);
    return true;
}

Result Sampling::sample() {
    const bool measured = vertices_.measure();
    stages_.end("measure vertices");
    if (!measured) return bounds_.result_without_bounds(a_.triangles, points_);
    bound_by_corners();
    bool has_edge = false;  // whether some triangle has an edge of positive length; only then can more samples help
    Index i = 0;
    for (; i < a_.triangles.rows(); ++i) {
        const double rest = rest_[static_cast<std::size_t>(i)];
        stopped_ = end(rest);
        if (stopped_) break;
        const double edge = squared_longest_edge(i), by_corners = grid_distance_at_most(corners_at_most(i), edge, 1);
        has_edge = has_edge || edge > 0;
        const bool may_raise = by_corners > query_.floor;
        const std::int64_t n = may_raise ? steps_of(edge) : 1;
        if (!may_raise)
            settle(by_corners, i);
        else if (!sample_triangle(i, n, by_corners))
            break;
        if (elements_)
            elements_->subdivided(i, static_cast<int>(n));  // not if it was stopped: the corners bound it then
    }
    const double rest = rest_[static_cast<std::size_t>(i)];
    for (; elements_ && i < a_.triangles.rows(); ++i) {
        if (WATCHED("sampling: fields of the triangles to come", true))
            elements_->settle(grid_distance_at_most(corners_at_most(i), squared_longest_edge(i), 1), i);
    }
    stages_.end("sample");
    Result result = bounds_.result(stopped_.value_or(has_edge ? Status::budget : Status::precision_floor),
                                   WATCHED("sampling: a stop counts the triangles to come", rest));
    if (result.status == Status::budget && !stopped_)
        result.note = "samples this far apart give no closer bounds: choose a smaller `step`";
    return result;
}

class SamplingSolver final : public MeshSolver<TriangleOctree> {
public:
    explicit SamplingSolver(const Options& options) : step_(options.real("step")) {}

    void prepare(const Scene& scene, const Prepared& prepared) override {
        MeshSolver::prepare(scene, prepared);
        length_ = step_ * diagonal(source().vertices);
    }

private:
    Result search(const MeshPair& pair, const Query& query, State*, Trace& trace) const override {
        return Sampling(pair, query, trace, length_).run();
    }

    double step_;
    double length_ = 0;  // `step` as a length
};

}  // namespace

SolverEntry solver() {
    SolverInfo info = mesh_solver_info<TriangleOctree>("sampling", "sampling", "cignoni1998");
    info.ignores_tolerance = true;
    info.parameters = {
        {.name = "step",
         .default_value = 0.005,
         .unit = "diagonals of A",
         .paper_value = "0.005 (default of the program MESH)",
         .description = "the longest distance of neighbouring samples along an edge of A, as a fraction of the "
                        "diagonal of A's box; the "
                        "gap is at most 0.58 of it",
         .least = 1e-6,
         .most = 1},
    };
    return {info, make_solver<SamplingSolver>};
}

}  // namespace hausbench::sampling
