// Midpoint subdivision after Guthe, Borodin, Klein: Fast and accurate Hausdorff distance calculation between meshes, WSCG
// 2005. That paper was not at hand: this follows the descriptions in Tang, Lee, Kim 2009 and Zhang et al. 2017. From
// there: an octree for proximity, subdivision at the midpoints of the edges, an upper bound for each triangle, purging of
// triangles that cannot attain the maximum, the end of a triangle whose vertices share a nearest triangle.
//
// Upper bound of a piece T with vertices v: the least, over some triangles S of B, of max_v d(v, S). The distance to a convex
// set is convex, so its maximum over T is at a vertex (exact if S is nearest to all three, even if ties named another: the
// shared-triangle end of Tang et al., section 4). Which S Guthe tries is not known. Ours are those nearest to the piece's
// vertices, to its siblings' vertices, and the one that was best for its parent. A Lipschitz bound, d(v, B) + the longest
// edge from v, cannot be less than that of the S nearest to v, so there is none.
// The piece of largest upper bound is split first. The lower bound is the largest distance of a vertex met so far.
//
// Split: `midpoint`, as published, makes four pieces of the same shape, so a needle stays a needle: k levels make 4^k pieces
// where 2^k would do. `longest_edge` (ours) halves the longest edge, which soon makes compact pieces of a needle.
//
// Certified: upper bounds are widened as kernel/rounding.h says. Purging by the uncertified lower bound does no harm, as
// the bounds of what is purged are kept; only the last witness is certified, by support planes (kernel/point_triangle.h).
// With certify = false nothing is widened or certified, and with kernel = textbook distances are those that textbooks give:
// both are there to be compared with, and their bounds may be wrong.
// Budget: subdivisions. Time O(n log m) for the vertices and O(log m) a subdivision on tame data; memory O(n + m) and 168
// bytes for each piece in the queue.
#include "kernel/deadline.h"
#include "kernel/rounding.h"
#include "kernel/textbook.h"
#include "kernel/triangle_block.h"
#include "solver.h"
#include "structures/octree.h"

#include <algorithm>
#include <array>

namespace hausbench {
namespace {

// By then a piece is smaller than rounding: four pieces have half the diameter of their parent; two halvings of the longest
// edge divide the diameter by 2, but for a factor of sqrt(3) in all.
constexpr int most_levels_midpoint = 50, most_levels_longest_edge = 102;
constexpr Index scan_at_most = 32;  // triangles of B that are as soon scanned as searched

struct Vertex {
    Vec3 point;
    double squared = -1;  // distance to B, squared; negative: not known yet
    Index triangle = -1;  // of B, nearest
};

struct Piece {
    std::array<Vertex, 3> corners;
    double upper;
    Index source;  // triangle of A
    Index best;    // triangle of B whose bound was least
    int level;
};

// Which piece to split next: the heap moves these, and the pieces stay where they are.
struct Queued {
    double upper;
    std::uint32_t piece;

    bool operator<(const Queued& other) const { return upper < other.upper; }
};

struct Choices {
    bool textbook = false, certify = true, longest_edge = false;
};

// A piece cut up: its corners (0, 1, 2), the midpoints of edges after them, and the pieces as three of these points each.
struct Cut {
    std::array<Vertex, 6> points;
    std::size_t point_count = 3, piece_count = 0;
    std::array<std::array<std::size_t, 3>, 4> pieces{};
};

// One query.
class Search {
public:
    Search(const TriangleMesh& a, const TriangleMesh& b, const TriangleOctree* octree, Points posed_vertices,
           const Query& query, Trace& trace, const Choices& choices)
        : a_(a),
          b_(b),
          octree_(octree),
          points_(std::move(posed_vertices)),
          query_(query),
          trace_(trace),
          textbook_(choices.textbook),
          longest_edge_(choices.longest_edge),
          deadline_(query.time_limit),
          rounding_{std::max(magnitude(points_), magnitude(b.vertices)), choices.certify} {}

    Result run();

private:
    ClosestPoint closest(const Vec3& point, Index warm);
    double squared_distance(const Vec3& point, const Triangle& triangle) const;
    void squared_distances(const Cut& cut, const Triangle& triangle, BlockFeet& feet) const;
    Vertex vertex_at(const Vec3& point, Index warm, Index source, int level);
    bool measure_vertices();
    void push_triangles();
    bool settle(const Piece& piece);
    void push(const Piece& piece);
    Piece pop();
    Cut cut(const Piece& piece);
    void split(const Piece& piece);
    double upper() const { return std::max(settled_, heap_.empty() ? 0.0 : heap_.front().upper); }
    double certified_lower();
    Result result(Status status);

    const TriangleMesh& a_;
    const TriangleMesh& b_;
    const TriangleOctree* octree_;
    Points points_;
    const Query& query_;
    Trace& trace_;
    bool textbook_, longest_edge_;
    Deadline deadline_;
    SurfaceRounding rounding_;
    Counters counters_;
    std::vector<Vertex> vertices_;  // of A
    std::vector<Queued> heap_;
    std::vector<Piece> pieces_;
    std::vector<std::uint32_t> free_;  // places in pieces_
    double settled_ = 0;               // the largest upper bound of what was purged
    Vertex farthest_;
    Index farthest_source_ = -1;
    int farthest_level_ = 0;
    double certified_ = -1;  // of farthest_, negative: to be computed
};

ClosestPoint Search::closest(const Vec3& point, Index warm) {
    ClosestHints hints;
    hints.warm_triangle = warm;
    if (!textbook_)
        return octree_ ? octree_->closest(point, hints, counters_) : closest_by_scan(b_, point, hints, counters_);

    ClosestPoint best;
    if (octree_) {
        best = octree_->textbook_closest(point, hints, counters_);
    } else {
        ++counters_.closest_point_queries;
        for (Index i = 0; i < b_.triangles.rows(); ++i) {
            ++counters_.point_triangle_distances;
            const TrianglePoint found = textbook_closest_point(point, triangle_of(b_, i));
            if (found.squared_distance <= best.squared_distance) offer(best, found, i);
        }
    }
    // All were NaN: something has to be answered.
    if (best.triangle < 0) best = {best.squared_distance, triangle_of(b_, 0).a, 0};
    return best;
}

double Search::squared_distance(const Vec3& point, const Triangle& triangle) const {
    return (textbook_ ? textbook_closest_point(point, triangle) : closest_point(point, triangle)).squared_distance;
}

// Of the points of a cut, lane by lane.
void Search::squared_distances(const Cut& cut, const Triangle& triangle, BlockFeet& feet) const {
    if (textbook_) {
        for (std::size_t k = 0; k < cut.point_count; ++k) {
            feet.squared_distance[k] = squared_distance(cut.points[k].point, triangle);
        }
        return;
    }
    PointBlock block;
    for (std::size_t lane = 0; lane < block_width; ++lane) {
        const Vec3& point = cut.points[std::min(lane, cut.point_count - 1)].point;
        for (int k = 0; k < 3; ++k) block.coordinate[k][lane] = point[k];
    }
    closest_points(block, triangle, feet);
}

Vertex Search::vertex_at(const Vec3& point, Index warm, Index source, int level) {
    const ClosestPoint nearest = closest(point, warm);
    const Vertex vertex{point, nearest.squared_distance, nearest.triangle};
    if (vertex.squared > farthest_.squared) {
        farthest_ = vertex;
        farthest_source_ = source;
        farthest_level_ = level;
        certified_ = -1;
    }
    return vertex;
}

// False: out of time.
bool Search::measure_vertices() {
    vertices_.resize(static_cast<std::size_t>(points_.rows()));
    Index warm = -1;
    for (Index i = 0; i < a_.triangles.rows(); ++i) {
        if (i % 128 == 0 && deadline_.passed()) return false;
        for (const Index v : a_.triangles.row(i)) {
            if (vertices_[static_cast<std::size_t>(v)].triangle >= 0)
                warm = vertices_[static_cast<std::size_t>(v)].triangle;
        }
        for (const Index v : a_.triangles.row(i)) {
            Vertex& vertex = vertices_[static_cast<std::size_t>(v)];
            if (vertex.triangle < 0) vertex = vertex_at(points_.row(v), warm, i, 0);
            warm = vertex.triangle;
        }
    }
    return true;
}

// Whether the piece needs no further work; its bound is kept.
bool Search::settle(const Piece& piece) {
    // Any bound that comes from vertices no farther than the farthest one is purged here: among them, exactly, those of
    // pieces whose vertices share a nearest triangle. What is below the floor is of no interest.
    const int most_levels = longest_edge_ ? most_levels_longest_edge : most_levels_midpoint;
    const double known = std::max(rounding_.at_most(farthest_.squared, piece.level), query_.floor);
    if (piece.upper > known && piece.level < most_levels) return false;
    settled_ = std::max(settled_, piece.upper);
    return true;
}

void Search::push(const Piece& piece) {
    if (settle(piece)) return;
    ++counters_.queue_pushes;
    std::uint32_t place = static_cast<std::uint32_t>(pieces_.size());
    if (free_.empty()) {
        pieces_.push_back(piece);
    } else {
        place = free_.back();
        free_.pop_back();
        pieces_[place] = piece;
    }
    heap_.push_back({piece.upper, place});
    std::push_heap(heap_.begin(), heap_.end());
}

Piece Search::pop() {
    std::pop_heap(heap_.begin(), heap_.end());
    free_.push_back(heap_.back().piece);
    heap_.pop_back();
    return pieces_[free_.back()];
}

void Search::push_triangles() {
    for (Index i = 0; i < a_.triangles.rows(); ++i) {
        Piece piece{};
        piece.source = i;
        for (int k = 0; k < 3; ++k) {
            piece.corners[static_cast<std::size_t>(k)] = vertices_[static_cast<std::size_t>(a_.triangles(i, k))];
        }
        double least = std::numeric_limits<double>::infinity();
        for (const Vertex& corner : piece.corners) {
            const Triangle near = triangle_of(b_, corner.triangle);
            double most = 0;
            for (const Vertex& other : piece.corners) {
                if (other.triangle == corner.triangle) {
                    most = std::max(most, other.squared);
                } else {
                    ++counters_.point_triangle_distances;
                    most = std::max(most, squared_distance(other.point, near));
                }
            }
            ++counters_.bound_tests;
            if (most < least) {
                least = most;
                piece.best = corner.triangle;
            }
        }
        piece.upper = rounding_.at_most(least, 0);
        push(piece);
    }
}

Cut Search::cut(const Piece& piece) {
    const int level = piece.level + 1;
    Cut cut;
    for (std::size_t k = 0; k < 3; ++k) cut.points[k] = piece.corners[k];
    const auto add_midpoint = [&](std::size_t a, std::size_t b) {
        const Vertex &one = cut.points[a], &two = cut.points[b];
        cut.points[cut.point_count++] = vertex_at(0.5 * (one.point + two.point), one.triangle, piece.source, level);
    };
    if (!longest_edge_) {  // 3, 4, 5 are the midpoints opposite 0, 1, 2
        for (std::size_t k = 0; k < 3; ++k) add_midpoint((k + 1) % 3, (k + 2) % 3);
        cut.pieces = {{{0, 5, 4}, {1, 3, 5}, {2, 4, 3}, {3, 4, 5}}};
        cut.piece_count = 4;
        return cut;
    }
    std::size_t opposite = 0;
    double longest = -1;
    for (std::size_t k = 0; k < 3; ++k) {
        const double length = squared_length(cut.points[(k + 1) % 3].point - cut.points[(k + 2) % 3].point);
        if (length > longest) longest = length, opposite = k;
    }
    const std::size_t one = (opposite + 1) % 3, two = (opposite + 2) % 3;
    add_midpoint(one, two);
    cut.pieces[0] = {opposite, one, 3};
    cut.pieces[1] = {opposite, 3, two};
    cut.piece_count = 2;
    return cut;
}

void Search::split(const Piece& piece) {
    ++counters_.subdivisions;
    const int level = piece.level + 1;
    const Cut cut = this->cut(piece);
    std::array<Index, 7> near{piece.best};
    for (std::size_t k = 0; k < cut.point_count; ++k) near[k + 1] = cut.points[k].triangle;

    std::array<double, 4> least;
    std::array<Index, 4> best{};
    least.fill(std::numeric_limits<double>::infinity());
    for (std::size_t s = 0; s <= cut.point_count; ++s) {
        if (std::find(near.begin(), near.begin() + s, near[s]) != near.begin() + s) continue;
        BlockFeet feet;
        squared_distances(cut, triangle_of(b_, near[s]), feet);
        const double* squared = feet.squared_distance;
        counters_.point_triangle_distances += cut.point_count;
        for (std::size_t c = 0; c < cut.piece_count; ++c) {
            ++counters_.bound_tests;
            const auto& corners = cut.pieces[c];
            const double most = std::max({squared[corners[0]], squared[corners[1]], squared[corners[2]]});
            if (most < least[c]) {
                least[c] = most;
                best[c] = near[s];
            }
        }
    }
    for (std::size_t c = 0; c < cut.piece_count; ++c) {
        const auto& corners = cut.pieces[c];
        Piece child{
            {cut.points[corners[0]], cut.points[corners[1]], cut.points[corners[2]]}, 0, piece.source, best[c], level};
        child.upper = std::min(piece.upper, rounding_.at_most(least[c], level));
        push(child);
    }
}

double Search::certified_lower() {
    if (!rounding_.certify) return std::sqrt(farthest_.squared);
    if (certified_ < 0) {
        const double distance = octree_ ? octree_->certified_distance(farthest_.point, counters_)
                                        : certified_distance_by_scan(b_, farthest_.point, counters_);
        certified_ = surface_distance_at_least(distance, rounding_.magnitude, farthest_level_);
    }
    return certified_;
}

Result Search::result(Status status) {
    Result result;
    result.bounds = {certified_lower(), std::max(upper(), certified_lower())};
    const ClosestPoint nearest = closest(farthest_.point, farthest_.triangle);
    result.witness = {farthest_.point, nearest.point, farthest_source_, nearest.triangle};
    result.counters = counters_;
    result.status = query_.answer(result.bounds.lower, result.bounds.upper).value_or(status);
    trace_.record(result.bounds.lower, result.bounds.upper);
    return result;
}

Result Search::run() {
    if (!measure_vertices()) {
        // The distance to one point of B is convex too: no triangle of A is farther than its vertices.
        const Vec3 point = b_.vertices.row(b_.triangles(0, 0));
        double most = 0;
        for (Index v = 0; v < points_.rows(); ++v) most = std::max(most, squared_length(Vec3(points_.row(v)) - point));
        settled_ = rounding_.at_most(most, 0);
        return farthest_.triangle < 0
                   ? Result{.status = Status::time_limit, .bounds = {0, settled_}, .witness = {}, .counters = counters_}
                   : result(Status::time_limit);
    }
    push_triangles();

    double loss = 0;  // what certifying the witness has cost so far
    while (true) {
        const double high = upper(), low = std::max(std::sqrt(farthest_.squared) - loss, 0.0);
        if (trace_.on()) trace_.record(certified_lower(), high);
        // Seemingly answered, or nothing is left to split. Certifying the witness costs a query, so it comes last.
        const std::optional<Status> seems = query_.answer(low, high);
        const bool done = heap_.empty() || heap_.front().upper <= settled_;
        if (seems || done) {
            if (const auto answer = query_.answer(certified_lower(), high)) return result(*answer);
        }
        if (seems == Status::converged || done) {
            if (!seems) return result(Status::precision_floor);
            loss = std::max(2 * loss, std::sqrt(farthest_.squared) - certified_lower());
            if (!(loss < query_.tolerance.gap(certified_lower()))) return result(Status::precision_floor);
            continue;
        }
        if (counters_.subdivisions >= query_.budget) return result(Status::budget);
        if (counters_.subdivisions % 64 == 0 && deadline_.passed()) return result(Status::time_limit);
        const Piece piece = pop();
        if (!settle(piece)) split(piece);  // the lower bound may have risen since it was pushed
    }
}

class Guthe final : public Solver {
public:
    explicit Guthe(const Options& options)
        : choices_{options.text("kernel") == "textbook", options.flag("certify"),
                   options.text("split") == "longest_edge"} {}

    bool certified() const override { return choices_.certify && !choices_.textbook; }

    Needs needs(const Scene& scene, const QuerySet&) const override {
        if (element_count(scene.target) <= scan_at_most) return {};
        return {need<TriangleOctree>(Side::target)};
    }

    void prepare(const Scene&, const Prepared& prepared) override {
        source_ = &prepared.triangles(Side::source);
        target_ = &prepared.triangles(Side::target);
        octree_ = prepared.has<TriangleOctree>(Side::target) ? &prepared.get<TriangleOctree>(Side::target) : nullptr;
    }

    Result solve(const Query& query, State*, Trace& trace) const override {
        Points points = posed(source_->vertices, query.source_pose);
        const double most = std::max(magnitude(points), magnitude(target_->vertices));
        if (!(most == 0 || (most >= smallest_safe_magnitude && most <= largest_safe_magnitude))) return {};
        return Search(*source_, *target_, octree_, std::move(points), query, trace, choices_).run();
    }

private:
    Choices choices_;
    const TriangleMesh* source_ = nullptr;
    const TriangleMesh* target_ = nullptr;
    const TriangleOctree* octree_ = nullptr;
};

}  // namespace

SolverEntry guthe_solver() {
    SolverInfo info;
    info.name = "guthe";
    info.title = "Guthe et al.";
    info.paper = "guthe2005";
    info.source.mesh = info.source.points = info.target.mesh = info.target.points = true;
    info.certified = true;
    info.traces = true;
    info.may_need = {need<TriangleOctree>(Side::target)};
    info.parameters = {
        {.name = "kernel",
         .default_value = std::string("robust"),
         .unit = "",
         .paper_value = "",
         .description = "the distance of a point to a triangle; textbook: not certified, to show how it fails",
         .choices = {"robust", "textbook"}},
        {.name = "certify",
         .default_value = true,
         .unit = "",
         .paper_value = "",
         .description = "account for rounding; off: bounds hold in exact arithmetic only, to measure the cost",
         .choices = {}},
        {.name = "split",
         .default_value = std::string("midpoint"),
         .unit = "",
         .paper_value = "midpoint",
         .description =
             "how a piece of A is cut: four pieces at the midpoints of its edges, or two at that of the longest "
             "edge, for needles",
         .choices = {"midpoint", "longest_edge"}},
    };
    return {info, [](const Options& options) -> std::unique_ptr<Solver> { return std::make_unique<Guthe>(options); }};
}

}  // namespace hausbench
