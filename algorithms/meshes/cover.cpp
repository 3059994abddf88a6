// Threshold cover: ours. Every triangle of A is shown to lie within tau of B, where tau is just above the largest distance that any
// point of A is known to have.
//
// 1. A lower bound l: the distance of one vertex of each of a few groups of neighbouring triangles of A, then of each quarter of them, down
//    to clusters of 16. A group is done with where that distance and the size of its box together are at most tau = l + 0.9 tolerance.
// 2. What is left is looked at eight triangles at a time, the most promising first, so that l is nearly final early. The triangles of
//    B that are near are gathered once, as frames in single precision (structures/triangle_blocks.h), and the distances of all corners
//    to them are found. If all three corners of a triangle are within tau of one triangle S of B, all of it is, as the tau-offset of S
//    is convex; if not, several are tried together (search/offset_cover.h).
// 3. What single precision cannot decide is done again at the end, in double precision, with a tau that is nearly final. A point that no
//    triangle of B is within tau of is measured exactly: it raises l, and tau with it.
// There is no queue, and no bound is ever made better: a triangle is covered once. Most are by step 2, with no query of their own.
//
// Upper bound: the largest of the distances that the covers and the groups have shown, not tau. Lower bound and witness: as in
// guthe.cpp. Rounding: search/offset_cover.h in coordinates of the place, so that it errs by parts of the place's size; kernel/rounding.h
// for groups, and for the pieces of triangles that are too large beside those of B and are halved first.
//
// Fields: those of guthe.cpp. Budget: cuts.
#include "kernel/posed_box.h"
#include "search/bounds.h"
#include "search/elements.h"
#include "search/mesh_solver.h"
#include "search/offset_cover.h"
#include "search/stages.h"
#include "structures/triangle_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

namespace hausbench {
namespace {

constexpr std::size_t cluster_triangles = 16, batch_triangles = 8;
constexpr std::size_t group_parts = 4, most_first_groups = 64;
constexpr std::size_t first_clusters = 32;     // the most promising ones
constexpr std::size_t most_work_in_float = 48; // cuts of one triangle
constexpr std::size_t most_gathered = 224;     // triangles of B, less than NearSet::most
constexpr int most_gathers = 40;               // for one piece, as tau rises
constexpr int most_halvings = 40;              // of a triangle of A beside which those of B are small

// Neighbouring triangles of A, by their place in the order; a cluster is the smallest kind of group.
struct Cluster {
    std::size_t begin, count;
    double upper;            // of their distance
    Vec3 at;                 // a point of A that was measured,
    double distance;         // its distance to B,
    Index near;              // the triangle of B that is nearest to it,
    bool own;                // and whether it belongs to the cluster itself
};

// A triangle of A or a part of it that single precision did not cover.
struct Undecided {
    std::array<Vec3, 3> corners;
    Index source;
    Index near;  // a triangle of B
    double upper;
    int level;  // halvings, as kernel/rounding.h counts them
};

class Search final : public CoverHost {
public:
    Search(const MeshPair& pair, const TriangleBlocks& blocks, const std::vector<Index>& order, const Query& query,
           Trace& trace)
        : a_(pair.source),
          points_(pair.points),
          target_(pair.target),
          blocks_(blocks),
          order_(order),
          query_(query),
          magnitude_(pair.magnitude),
          elements_(query.wanted.fields ? std::make_optional<ElementBounds>(a_.triangles.rows()) : std::nullopt),
          stages_(query.wanted.stages),
          bounds_(query, target_, {pair.magnitude, true}, counters_, trace, elements_ ? &*elements_ : nullptr),
          place_of_vertex_(static_cast<std::size_t>(a_.vertices.rows()), -1) {}

    Result run();

    Index measure(const double (&point)[3], int level, Index near) override;
    double threshold() const override { return tau() * exact_.near.units.inverse; }
    bool promising(double distance) const override;
    bool go_on() override;

private:
    double tau() const;
    Vec3 vertex(Index i) const { return points_.row(i); }
    Triangle triangle(Index i) const {
        const auto v = a_.triangles.row(i);
        return {vertex(v[0]), vertex(v[1]), vertex(v[2])};
    }
    bool stopped();
    double around(const Vec3& at, double distance, const Box& box) const;
    void measure_groups();
    void look_around(const Cluster& group, std::size_t begin, std::size_t count, const Box& box);
    void order_clusters();
    void look(const Cluster& cluster);
    void cover_batch(const Cluster& cluster, std::span<const Index> triangles);
    void settle(double upper, Index source) { bounds_.settle(upper, source, 0, 0); }
    void settle_all(const Cluster& cluster);
    void decide(const Undecided& piece);
    bool cover_alone(const Undecided& piece, bool gathered_all);
    void count();

    const TriangleMesh& a_;
    const Points& points_;
    const Target& target_;
    const TriangleBlocks& blocks_;
    const std::vector<Index>& order_;
    const Query& query_;
    double magnitude_;
    Counters counters_;
    std::optional<ElementBounds> elements_;
    Stages stages_;
    SearchBounds bounds_;
    std::vector<Cluster> clusters_;
    std::vector<Undecided> undecided_;
    OffsetCover<float> cover_;
    OffsetCover<double> exact_;
    std::vector<std::int8_t> place_of_vertex_;  // among those of a batch, or -1
    Index source_ = -1;                         // of the piece that is covered now
    int level_ = 0;
    std::optional<Status> stop_;
};

double Search::tau() const {
    const double low = std::sqrt(std::max(bounds_.farthest().point.squared, 0.0));
    return std::max(low + 0.9 * query_.tolerance.gap(low), query_.floor);
}

bool Search::stopped() {
    if (!stop_ && bounds_.out_of_time()) stop_ = Status::time_limit;
    return stop_.has_value();
}

// No point of the box is farther from B than `at` is, and then some.
double Search::around(const Vec3& at, double distance, const Box& box) const {
    return surface_sum_at_most(distance + std::sqrt(squared_distance_at_most(at, box)), magnitude_, 0);
}

// --- 1. groups, ever smaller -------------------------------------------------------------------------------------------

// Level by level, so that l is nearly final when the small groups, which are many, have their turn. Leaves clusters, or stops.
void Search::measure_groups() {
    std::vector<std::vector<Box>> boxes(1);
    for (std::size_t begin = 0; begin < order_.size(); begin += cluster_triangles) {
        Box& box = boxes[0].emplace_back();
        const std::size_t end = std::min(begin + cluster_triangles, order_.size());
        for (std::size_t i = begin; i < end; ++i)
            for (const Index v : a_.triangles.row(order_[i])) box.add(vertex(v));
    }
    while (boxes.back().size() > most_first_groups) {
        const std::vector<Box>& below = boxes.back();
        std::vector<Box> level((below.size() + group_parts - 1) / group_parts);
        for (std::size_t i = 0; i < below.size(); ++i) level[i / group_parts].add(below[i]);
        boxes.push_back(std::move(level));
    }
    std::size_t size = cluster_triangles;  // triangles of a group
    for (std::size_t level = 1; level < boxes.size(); ++level) size *= group_parts;
    clusters_.assign(1, {0, order_.size(), std::numeric_limits<double>::infinity(), Vec3::Zero(), 0, -1, false});
    for (std::size_t level = boxes.size(); level-- > 0; size /= group_parts) {
        std::vector<Cluster> groups;
        groups.swap(clusters_);
        for (const Cluster& group : groups) {
            for (std::size_t begin = group.begin; begin < group.begin + group.count; begin += size) {
                const std::size_t count = std::min(size, group.begin + group.count - begin);
                look_around(group, begin, count, boxes[level][begin / size]);
            }
        }
        if (stopped()) return;
    }
}

// A part of a group: settled, or one of the next groups. A query for it is worth its cost only where tau is not far below its size.
void Search::look_around(const Cluster& group, std::size_t begin, std::size_t count, const Box& box) {
    Cluster part = group;
    part.begin = begin;
    part.count = count;
    part.own = false;
    if (group.near >= 0) part.upper = std::min(group.upper, around(group.at, group.distance, box));
    ++counters_.bound_tests;
    const double size = std::sqrt(squared_length(box.high - box.low));
    if (group.near < 0 || (part.upper > tau() && tau() >= 0.25 * size && !stop_)) {
        // The corner of a triangle in the middle that the box is least around.
        const Index source = order_[begin + count / 2];
        const Triangle t = triangle(source);
        double least = std::numeric_limits<double>::infinity();
        for (const Vec3* corner : {&t.a, &t.b, &t.c}) {
            const double far = squared_distance_at_most(*corner, box);
            if (far < least) least = far, part.at = *corner;
        }
        const MeasuredPoint m = bounds_.measure(part.at, group.near, source, 0);
        part.near = m.triangle;
        part.distance = std::sqrt(m.squared);
        part.upper = std::min(part.upper, around(m.point, part.distance, box));
        part.own = true;
        if (counters_.closest_point_queries % 64 == 0) (void)stopped();
    }
    if (part.upper <= tau())
        settle_all(part);
    else
        clusters_.push_back(part);
}

void Search::settle_all(const Cluster& cluster) {
    for (std::size_t i = cluster.begin; i < cluster.begin + cluster.count; ++i) settle(cluster.upper, order_[i]);
}

// The most promising first; the others as neighbours.
void Search::order_clusters() {
    const std::size_t first = std::min(first_clusters, clusters_.size());
    std::vector<std::size_t> best(clusters_.size());
    std::iota(best.begin(), best.end(), std::size_t{0});
    const auto promise = [&](std::size_t i) { return clusters_[i].distance + 0.3 * clusters_[i].upper; };
    std::partial_sort(best.begin(), best.begin() + static_cast<std::ptrdiff_t>(first), best.end(),
                      [&](std::size_t i, std::size_t j) {
                          const double x = promise(i), y = promise(j);
                          return x != y ? x > y : i < j;
                      });
    std::sort(best.begin() + static_cast<std::ptrdiff_t>(first), best.end());
    std::vector<Cluster> ordered;
    ordered.reserve(clusters_.size());
    for (const std::size_t i : best) ordered.push_back(clusters_[i]);
    clusters_ = std::move(ordered);
}

// --- 2. covers in single precision -------------------------------------------------------------------------------------

void Search::look(const Cluster& cluster) {
    ++counters_.bound_tests;
    if (cluster.upper <= tau() || stop_) return settle_all(cluster);
    for (std::size_t i = cluster.begin; i < cluster.begin + cluster.count; i += batch_triangles) {
        const std::size_t count = std::min(batch_triangles, cluster.begin + cluster.count - i);
        cover_batch(cluster, std::span(order_).subspan(i, count));
    }
}

// The vertices of some triangles, each once, in coordinates of a place around them.
struct Batch {
    std::array<Index, 3 * batch_triangles> vertex;
    std::array<std::array<std::size_t, 3>, batch_triangles> corners;  // of each triangle, among the vertices
    CoverPoints<float> points;
    LocalUnits place;
    double radius = 0;  // around the origin of the place
};

void Search::cover_batch(const Cluster& cluster, std::span<const Index> triangles) {
    Batch batch;
    Box box;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const auto row = a_.triangles.row(triangles[i]);
        for (std::size_t k = 0; k < 3; ++k) {
            const Index v = row[static_cast<Index>(k)];
            std::int8_t& place = place_of_vertex_[static_cast<std::size_t>(v)];
            if (place < 0) {
                place = static_cast<std::int8_t>(batch.points.count);
                batch.vertex[batch.points.count++] = v;
                box.add(vertex(v));
            }
            batch.corners[i][k] = static_cast<std::size_t>(place);
        }
    }
    batch.place.set(box, magnitude_ * 0x1p-100);
    const Vec3 centre(batch.place.origin[0], batch.place.origin[1], batch.place.origin[2]);
    for (std::size_t i = 0; i < batch.points.count; ++i) {
        const Vec3 local = vertex(batch.vertex[i]) - centre;
        batch.radius = std::max(batch.radius, squared_length(local));
        batch.points.x[i] = static_cast<float>(local[0] * batch.place.inverse);
        batch.points.y[i] = static_cast<float>(local[1] * batch.place.inverse);
        batch.points.z[i] = static_cast<float>(local[2] * batch.place.inverse);
        place_of_vertex_[static_cast<std::size_t>(batch.vertex[i])] = -1;
    }
    batch.radius = std::sqrt(batch.radius);

    // All triangles that may cover a part, unless tau is so large that it would be most of B: then those near the surface.
    const double at_centre = cluster.distance + std::sqrt(squared_length(centre - cluster.at));
    const double radius = cluster.own ? std::min(tau(), 1.5 * cluster.distance + 0.15 * batch.radius) : tau();
    cover_.near.clear(batch.place);
    blocks_.gather(centre, std::min(radius, at_centre + batch.radius) + batch.radius, cover_.near, counters_);
    const bool crowded = cover_.near.count() > most_gathered;
    if (!crowded && cover_.near.count() > 0) {
        cover_.make_rows(most_shared_points + most_polygon_corners + 4);
        cover_.set_threshold(tau() * batch.place.inverse);
        measure_shared(cover_, batch.points);
    }
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        CoverResult result;
        if (!crowded && cover_.near.count() > 0) {
            CoverPolygon<float> piece;
            for (const std::size_t k : batch.corners[i])
                piece.add(batch.points.x[k], batch.points.y[k], batch.points.z[k], 0);
            result = cover_shared(cover_, piece, batch.corners[i], most_work_in_float);
        }
        const Index source = triangles[i];
        if (result.covered) {
            settle(result.upper * batch.place.unit * (1 + 4 * unit_roundoff), source);
            continue;
        }
        const Triangle t = triangle(source);
        const Index near = cluster.near;
        undecided_.push_back({{t.a, t.b, t.c}, source, near, cluster.upper, 0});
    }
    count();
}

// Work of the covers so far, for the counters.
void Search::count() {
    const auto add = [&](auto& cover) {
        counters_.point_triangle_distances += cover.distances;
        counters_.bound_tests += cover.tests;
        counters_.subdivisions += cover.cuts;
        cover.distances = cover.tests = cover.cuts = 0;
    };
    add(cover_);
    add(exact_);
}

// --- 3. what is left ------------------------------------------------------------------------------------------------------

Index Search::measure(const double (&point)[3], int level, Index near) {
    const LocalUnits& place = exact_.near.units;
    Vec3 global;
    for (int k = 0; k < 3; ++k) global[k] = place.origin[k] + place.unit * point[k];
    // Within 9u level of the piece, in units of the place; rounding the sum takes less than 2uM.
    const int own = level_ + 1 + static_cast<int>(std::ceil(5 * (level + 1) * place.unit / magnitude_));
    return bounds_.measure(global, near, source_, own).triangle;
}

bool Search::promising(double distance) const {
    const double low = std::sqrt(std::max(bounds_.farthest().point.squared, 0.0));
    return distance * exact_.near.units.unit > low + 0.2 * query_.tolerance.gap(low);
}

bool Search::go_on() {
    if (stop_) return false;
    count();
    if (counters_.subdivisions >= query_.budget) stop_ = Status::budget;
    if (counters_.subdivisions % 64 == 0) (void)stopped();
    return !stop_;
}

void Search::decide(const Undecided& piece) {
    // The corners first: they may raise tau, and their distances may be enough.
    double edge = 0, least = std::numeric_limits<double>::infinity();
    Undecided measured = piece;
    if (piece.upper <= tau() || stop_) return settle(piece.upper, piece.source);
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& corner = piece.corners[k];
        const MeasuredPoint m = bounds_.measure(corner, measured.near, piece.source, piece.level);
        measured.near = m.triangle;
        edge = std::sqrt(std::max(squared_length(piece.corners[(k + 1) % 3] - corner),
                                  squared_length(piece.corners[(k + 2) % 3] - corner)));
        least = std::min(least, surface_sum_at_most(std::sqrt(m.squared) + edge, magnitude_, piece.level));
    }
    measured.upper = std::min(piece.upper, least);
    ++counters_.bound_tests;
    if (measured.upper <= tau() || stopped()) return settle(measured.upper, piece.source);
    if (cover_alone(measured, false)) return;
    // Too many triangles of B are near: the longest edge is halved.
    std::size_t a = 0;
    double longest = -1;
    for (std::size_t k = 0; k < 3; ++k) {
        const double squared = squared_length(piece.corners[(k + 1) % 3] - piece.corners[k]);
        if (squared > longest) longest = squared, a = k;
    }
    const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
    const Vec3 middle = 0.5 * (piece.corners[a] + piece.corners[b]);
    if (piece.level >= most_halvings || middle == piece.corners[a] || middle == piece.corners[b]) {
        cover_alone(measured, true);
        return;
    }
    ++counters_.subdivisions;
    if (elements_) elements_->subdivided(piece.source, piece.level + 1);
    decide({{piece.corners[a], middle, piece.corners[c]}, piece.source, measured.near, measured.upper, piece.level + 1});
    decide({{middle, piece.corners[b], piece.corners[c]}, piece.source, measured.near, measured.upper, piece.level + 1});
}

// False: so many triangles of B are near that the piece had better be halved; unless `whatever`, which takes some of them.
bool Search::cover_alone(const Undecided& piece, bool whatever) {
    Box box;
    for (const Vec3& corner : piece.corners) box.add(corner);
    LocalUnits place;
    place.set(box, magnitude_ * 0x1p-100);
    const Vec3 centre(place.origin[0], place.origin[1], place.origin[2]);
    double radius = 0;
    for (const Vec3& corner : piece.corners) radius = std::max(radius, squared_length(corner - centre));
    radius = std::sqrt(radius);
    const MeasuredPoint at_centre = {centre, target_.closest(centre, piece.near, counters_).squared_distance, piece.near};
    const double far = std::sqrt(at_centre.squared);
    source_ = piece.source;
    level_ = piece.level;
    CoverPolygon<double> polygon;
    for (const Vec3& corner : piece.corners) {
        const Vec3 local = (corner - centre) * place.inverse;
        polygon.add(local[0], local[1], local[2], 0);
    }
    CoverResult result;
    for (int turn = 0; !result.covered && turn < most_gathers; ++turn) {
        cover_.near.clear(place);
        blocks_.gather(centre, std::min(tau(), far + radius) + radius, cover_.near, counters_);
        std::vector<Index> triangles = cover_.near.triangle;
        if (triangles.size() > most_gathered) {
            if (!whatever) return false;
            triangles.resize(most_gathered);
        }
        if (triangles.empty()) triangles.push_back(piece.near);
        exact_.near.clear(place);
        set_frames(target_.mesh(), triangles, exact_.near);
        exact_.set_threshold(tau() * place.inverse);
        result = cover_surely(exact_, polygon, *this, target_.mesh());
    }
    count();
    const double upper = surface_sum_at_most(result.upper * place.unit, magnitude_, piece.level);
    settle(result.covered ? std::min(piece.upper, upper) : piece.upper, piece.source);
    return true;
}

Result Search::run() {
    measure_groups();
    if (stop_) return bounds_.result_without_bounds(a_.triangles, points_);
    stages_.end("measure groups");
    order_clusters();
    const auto decide_all = [&] {
        std::vector<Undecided> pieces;
        pieces.swap(undecided_);
        std::stable_sort(pieces.begin(), pieces.end(), [](const Undecided& x, const Undecided& y) { return x.upper > y.upper; });
        for (const Undecided& piece : pieces) decide(piece);
    };
    for (std::size_t i = 0; i < clusters_.size(); ++i) {
        if (i == first_clusters) {
            decide_all();
            stages_.end("first clusters");
        }
        if (i % 16 == 0) (void)stopped();
        look(clusters_[i]);
    }
    stages_.end("cover in single precision");
    decide_all();
    stages_.end("cover in double precision");
    const std::optional<Status> answer = bounds_.answered(0);
    Result result = bounds_.result(stop_ ? *stop_ : answer.value_or(Status::precision_floor), 0);
    if (elements_) result.fields = bounds_.fields();
    result.reported = stages_.seconds();
    return result;
}

class Cover final : public MeshSolver<TriangleBlocks> {
public:
    Needs needs(const Scene&, const QuerySet&) const override {
        return {need<TriangleBlocks>(Side::target), need<TriangleOrder>(Side::source)};
    }

    void prepare(const Scene& scene, const Prepared& prepared) override {
        MeshSolver::prepare(scene, prepared);
        order_ = &prepared.get<TriangleOrder>(Side::source);
    }

private:
    Result search(const MeshPair& pair, const Query& query, State*, Trace& trace) const override {
        return Search(pair, *tree(), order_->order, query, trace).run();
    }

    const TriangleOrder* order_ = nullptr;
};

}  // namespace

SolverEntry cover_solver() {
    SolverInfo info = mesh_solver_info<TriangleBlocks>("cover", "cover (ours)", "");
    info.may_need.push_back(need<TriangleOrder>(Side::source));
    return {info, [](const Options&) -> std::unique_ptr<Solver> { return std::make_unique<Cover>(); }};
}

}  // namespace hausbench
