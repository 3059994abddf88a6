// Cross-culling and Voronoi subdivision: Tang, Lee, Kim: Interactive Hausdorff distance computation for general polygonal models,
// ACM Transactions on Graphics 28(3), 2009.
//
// Three steps. Culling on A: a BVH of A is searched from its root; all triangles below a node are left out if its volume is no
// farther from some point q of B than the lower bound (Eqs. 8, 9). Culling on B: a triangle T of A that is left goes through the BVH
// of B; a node farther from T than T's upper bound u is left out. What remains gives the distances of T's corners and u = the least
// h(T, S) over the triangles S of B (Eqs. 10, 11). Subdivision: T is cut until it is settled, the piece of largest upper bound
// first; the pieces take the place of B by the list L of triangles S of B with d(T, S) <= u (Lemma 3).
//
// From the paper: all that, swept sphere volumes, group traversal (the three corners go through B together, and a leaf is measured
// against all of them), Voronoi subdivision, the end of a piece whose corners have a nearest triangle in common: then some S in L has
// h(T, S) = the largest distance of a corner, and u settles the piece. Ties need no care, as L holds each of the triangles that tie.
// Ours: nodes of A whose volume is farthest from B come first, and q is the closest point to the middle of a volume; leaves hold up
// to eight triangles, not four, for the vector kernels; and `longest_edge`. Left out: motion, two sides and penetration depth.
//
// L: a piece T with corners v_i keeps S only if d(v_i, S) <= u + e_i for all i, e_i the longest edge at v_i. Let S be nearest to some
// p of T. Then d(p, S) <= h(T, B) <= u and |v_i - p| <= e_i, so S stays. Rounding: T stands for an exact piece within 2k uM of it, k
// its level (kernel/rounding.h), so e_i may be 6k uM too small; and a computed distance may be 10uM too large, as measured, and 4u
// of itself. (32 + 8k) uM is added, and 8u of the sum. No bound rests on it: h(T, S) is an upper bound whatever S is, and the
// farthest point is measured again against all of B. Were S missing, the search might end with `precision_floor`.
// A list of more than `most_listed` triangles is not kept: such a piece is measured by closest point queries, and its parts are
// given another chance when they are small enough for a list to be likely. So a piece takes the same memory whatever B is,
// duplicates and the centre of a sphere too.
//
// Voronoi: an edge whose ends have different nearest triangles is cut where it is as far from the plane of the one as from that of
// the other; any other one, and where there is no such place, at its midpoint. Ours: a cut leaves at least `least_part` of the edge
// on either side, so that pieces shrink and stay compact (0.25: with 0.05 there are more splits than at midpoints); below
// `voronoi_depth` subdivisions midpoints take over. Where neighbours in B lie in one plane, as in a mesh that was subdivided, cuts
// do not find their common edge: `midpoint` does there if B was cut at midpoints.
//
// Certified: upper bounds are widened as kernel/rounding.h says, volumes as search/volumes.cpp does; the lower bound as in
// search/bounds.h. Where A was moved, its volumes are moved with it.
// Warm start (where the caller gives a State): the point that was farthest at the pose before is measured first.
//
// Fields: those of guthe.cpp; triangles that were culled with a node have that node's bound.
// Reports: "culled on A", the share of A's triangles that were settled before culling on B; "culled on B", the share of B's triangles
// that were not measured against a triangle of A that was not culled; "depth", the largest number of subdivisions.
//
// Budget: subdivisions. Time O(n log n + m log m) to prepare. Memory O(n + m), and 184 bytes and
// its list, 4 bytes a triangle, for each piece in the queue.
#include "search/bounds.h"
#include "search/elements.h"
#include "search/mesh_solver.h"
#include "search/near_walk.h"
#include "search/piece_bounds.h"
#include "search/queue.h"
#include "search/short_lists.h"
#include "search/stages.h"
#include "search/volumes.h"
#include "search/warm_start.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace hausbench {
namespace {

constexpr std::size_t most_listed = 32, most_near = 128;  // triangles of B: in a list, and before it is filtered
constexpr int voronoi_depth = 16;
constexpr double infinity = std::numeric_limits<double>::infinity();

enum class Cutting { voronoi, midpoint, longest_edge };

struct Choices {
    Cutting cutting = Cutting::voronoi;
    bool group = true;
    double least_part = 0.25;
};

using Lists = ShortLists<most_listed>;

struct Piece {
    PieceCorners corners;
    double upper = infinity;
    Index source = -1;  // triangle of A
    Index best = -1;    // triangle of B whose bound was least
    int level = 0;      // of rounding
    int depth = 0;
    Lists::List list;         // empty: there is none
    std::uint64_t crowd = 0;  // triangles of B that seem to be near, where there is no list
};

// A triangle of B, and its squared distance to each corner of a piece.
struct Near {
    Index triangle;
    std::array<double, 3> squared;
};

// Triangles of B, and their squared distances to the vertices of a piece that is cut.
struct Candidates {
    std::array<Index, most_listed> triangle;
    std::array<BlockFeet, most_listed> feet;
    std::size_t count = 0;

    void add(Index one) { triangle[count++] = one; }
};

// A node of A's tree, or a leaf.
struct Branch {
    double upper;       // bound of all below it
    double rest;        // the largest bound from here down the stack
    ClosestPoint near;  // on B
    std::int32_t child;
};

int most_levels(Cutting cutting) {
    if (cutting == Cutting::longest_edge) return most_levels(Split::longest_edge);
    return most_levels(Split::midpoint) + (cutting == Cutting::voronoi ? level_of_long_edge * voronoi_depth : 0);
}

// The place on an edge that is as far from the plane of one triangle of B as from that of another: of the two planes that halve the
// angle between these, on the one that has the triangles on either side, as seen from their centres.
double voronoi_place(const Vec3& from, const Vec3& to, const Triangle& one, const Triangle& two, double least_part) {
    const auto normal = [](const Triangle& t) { return Vec3((t.b - t.a).cross(t.c - t.a).normalized()); };
    const auto centre = [](const Triangle& t) { return Vec3((t.a + t.b + t.c) / 3.0); };
    const Vec3 n = normal(one), m = normal(two);
    const auto from_one = [&](const Vec3& p) { return dot(n, p - one.a); };
    const auto from_two = [&](const Vec3& p) { return dot(m, p - two.a); };
    const double sign = from_one(centre(two)) * from_two(centre(one)) < 0 ? -1 : 1;
    const double at_from = from_one(from) - sign * from_two(from), at_to = from_one(to) - sign * from_two(to);
    const double t = at_from / (at_from - at_to);
    // Where the planes are one, up to rounding, they say nothing.
    const bool clear = std::abs(at_from - at_to) > 1e-6 * std::sqrt(squared_length(to - from));
    return clear && t > 0 && t < 1 ? std::clamp(t, least_part, 1 - least_part) : 0.5;
}

// One query.
template <class Tree> class Search {
public:
    Search(const MeshPair& pair, const Tree* a_tree, const Tree* b_tree, const Query& query, WarmStart* warm_start,
           Trace& trace, const Choices& choices)
        : a_(pair.source),
          points_(pair.points),
          target_(pair.target),
          magnitude_(pair.magnitude),
          a_tree_(a_tree),
          b_tree_(b_tree),
          pose_(query.source_pose),
          warm_start_(warm_start),
          choices_(choices),
          elements_(query.wanted.fields ? std::make_optional<ElementBounds>(a_.triangles.rows()) : std::nullopt),
          stages_(query.wanted.stages),
          bounds_(query, target_, {magnitude_}, counters_, trace, elements_ ? &*elements_ : nullptr),
          pieces_(target_, magnitude_, counters_),
          vertices_(static_cast<std::size_t>(points_.rows())) {}

    Result run() {
        Result result = search();
        if (warm_start_ && bounds_.farthest().source >= 0)
            warm_start_->remember(bounds_.farthest(), posed_triangle(bounds_.farthest().source));
        if (elements_) {
            for (const Branch& branch : branches_) settle_below(branch.child, branch.upper);
            queue_.for_each([&](const Piece& piece) { elements_->settle(piece.upper, piece.source); });
            result.fields = bounds_.fields();
        }
        result.reported = stages_.seconds();
        const auto n = static_cast<double>(a_.triangles.rows()),
                   m = static_cast<double>(target_.mesh().triangles.rows());
        result.reported["culled on A"] = 1 - static_cast<double>(left_) / n;
        if (left_ > 0)
            result.reported["culled on B"] = 1 - static_cast<double>(left_on_b_) / (m * static_cast<double>(left_));
        result.reported["depth"] = static_cast<double>(deepest_);
        return result;
    }

private:
    Result search();
    void begin_warm();
    std::optional<Status> cull_on_a();
    void expand(const Branch& branch);
    void settle_below(std::int32_t child, double upper);
    void look_into(Index i);
    void measure_corners(Piece& piece);
    void cull_on_b(Piece& piece);
    template <class Visit> void near_triangles(const Piece& piece, const double& reach, const Visit& visit);
    void bound_by(Piece& piece, Index triangle);
    void list(Piece& piece);
    void split(Piece piece);
    void push(const Piece& piece);
    bool settle(const Piece& piece) {
        return bounds_.settle(piece.upper, piece.source, piece.level, most_levels(choices_.cutting));
    }
    double slack(int level) const { return (32 + 8 * level) * unit_roundoff * magnitude_; }
    template <class Measure>
    Cut<MeasuredPoint> cut_piece(const PieceCorners& corners, bool voronoi, const Measure& measure) const;
    int level_of_cut(const Piece& piece, bool voronoi) const;
    Candidates candidates(const Piece& piece, const Cut<MeasuredPoint>& cut) const;
    void measure(Candidates& candidates, Cut<MeasuredPoint>& cut);
    Triangle posed_triangle(Index i) const {
        const auto v = a_.triangles.row(i);
        return {points_.row(v[0]), points_.row(v[1]), points_.row(v[2])};
    }

    const TriangleMesh& a_;
    const Points& points_;
    const Target& target_;
    double magnitude_;
    const Tree* a_tree_;
    const Tree* b_tree_;
    VolumePose pose_;
    WarmStart* warm_start_;
    Choices choices_;
    Counters counters_;
    std::optional<ElementBounds> elements_;  // only where fields are wanted
    Stages stages_;
    SearchBounds bounds_;
    PieceBounds pieces_;
    std::vector<MeasuredPoint> vertices_;  // of A
    std::vector<Branch> branches_;         // what is left of A's tree, the largest bound last
    PieceQueue<Piece> queue_;
    Lists lists_;             // of pieces in the queue
    std::vector<Near> near_;  // what may be nearest to a point of a piece
    Index last_ = -1;         // triangle of B, best for the last triangle of A
    std::uint64_t left_ = 0, left_on_b_ = 0;
    int deepest_ = 0;
};

template <class Tree> void Search<Tree>::settle_below(std::int32_t child, double upper) {
    if (child < 0) {
        for (const Index i : a_tree_->tree().leaf(static_cast<std::size_t>(~child))) elements_->settle(upper, i);
        return;
    }
    const WideNode& node = a_tree_->tree().nodes[static_cast<std::size_t>(child)];
    for (int c = 0; c < node.count; ++c) settle_below(node.child[c], upper);
}

// Bounds what is below each child, and pushes those that are not culled, the largest bound last.
//
// No point inside is farther from q than its volume is. q is within 7uM of B (kernel/point_triangle.h): 8uM is added, and next_up
// makes up for rounding the sum.
template <class Tree> void Search<Tree>::expand(const Branch& branch) {
    const auto at = static_cast<std::size_t>(branch.child);
    const WideNode& node = a_tree_->tree().nodes[at];
    counters_.node_visits += static_cast<std::uint64_t>(node.count);
    std::array<Branch, tree_width> kept;
    std::size_t count = 0;
    for (int c = 0; c < node.count; ++c) {
        const CornerVolume volume = pose_(corners_of(*a_tree_, at, c));
        const auto bound = [&](const Vec3& q) {
            ++counters_.bound_tests;
            return next_up(distance_at_most(volume, q) + 8 * unit_roundoff * magnitude_);
        };
        Branch child{std::min(branch.upper, bound(branch.near.point)), 0, branch.near, node.child[c]};
        // Whatever q is, a volume is as far from it as half its own size.
        const double purged = bounds_.purged_at_most(0);
        const double size = 0.5 * std::sqrt(squared_length(volume.corner[0] - volume.corner[volume.count - 1]));
        if (child.upper > purged && (child.child >= 0 || size + volume.radius < purged)) {
            child.near = target_.closest(volume.centre(), branch.near.triangle, counters_);
            child.upper = std::min(child.upper, bound(child.near.point));
        }
        std::size_t place = count++;
        for (; place > 0 && kept[place - 1].upper > child.upper; --place) kept[place] = kept[place - 1];
        kept[place] = child;
    }
    for (std::size_t c = 0; c < count; ++c) {
        kept[c].rest = std::max(kept[c].upper, branches_.empty() ? 0 : branches_.back().rest);
        branches_.push_back(kept[c]);
    }
}

// Ends with a status, or where all of A is culled or in the queue.
template <class Tree> std::optional<Status> Search<Tree>::cull_on_a() {
    const ClosestPoint first = target_.closest(points_.row(0), -1, counters_);
    double most = 0;
    for (Index v = 0; v < points_.rows(); ++v)
        most = std::max(most, squared_length(Vec3(points_.row(v)) - first.point));
    const double upper = bounds_.at_most(most, 0);
    branches_.push_back({upper, upper, first, 0});
    while (!branches_.empty()) {
        const double rest = std::max(branches_.back().rest, queue_.upper());
        if (bounds_.out_of_time()) return Status::time_limit;
        if (bounds_.answered(rest) == Status::above_cutoff) return Status::above_cutoff;
        const Branch branch = branches_.back();
        branches_.pop_back();
        if (branch.upper <= bounds_.purged_at_most(0)) {
            bounds_.settle(branch.upper, 0, 0, 1);
            if (elements_) settle_below(branch.child, branch.upper);
        } else if (branch.child >= 0) {
            expand(branch);
        } else {
            for (const Index i : a_tree_->tree().leaf(static_cast<std::size_t>(~branch.child))) look_into(i);
        }
    }
    return std::nullopt;
}

// Lowers the upper bound by h(T, S) of one triangle S of B.
template <class Tree> void Search<Tree>::bound_by(Piece& piece, Index triangle) {
    const Triangle near = target_.triangle(triangle);
    double most = 0;
    for (const MeasuredPoint& corner : piece.corners) {
        const bool known = corner.triangle == triangle;
        most = std::max(most, known ? corner.squared : target_.squared_distance(corner.point, near));
        counters_.point_triangle_distances += known ? 0 : 1;
    }
    ++counters_.bound_tests;
    const double upper = bounds_.at_most(most, piece.level);
    if (upper < piece.upper) piece.upper = upper, piece.best = triangle;
}

template <class Tree> void Search<Tree>::look_into(Index i) {
    Piece piece;
    piece.source = i;
    for (int k = 0; k < 3; ++k) {
        const Index v = a_.triangles(i, k);
        piece.corners[static_cast<std::size_t>(k)] = vertices_[static_cast<std::size_t>(v)];
        piece.corners[static_cast<std::size_t>(k)].point = points_.row(v);
    }
    if (last_ >= 0) bound_by(piece, last_);
    for (const MeasuredPoint& corner : piece.corners) {
        if (corner.triangle < 0) continue;
        if (elements_) bounds_.offer(corner, i, 0);
        if (corner.triangle != piece.best) bound_by(piece, corner.triangle);
    }
    if (piece.best >= 0 && settle(piece)) return;
    ++left_;
    if (choices_.group)
        cull_on_b(piece);
    else
        measure_corners(piece);
    for (int k = 0; k < 3; ++k)
        vertices_[static_cast<std::size_t>(a_.triangles(i, k))] = piece.corners[static_cast<std::size_t>(k)];
    last_ = piece.best;
    if (settle(piece)) return;
    if (choices_.group) list(piece);
    push(piece);
}

// Each by itself.
template <class Tree> void Search<Tree>::measure_corners(Piece& piece) {
    const std::uint64_t before = counters_.point_triangle_distances;
    Index warm = last_;
    for (MeasuredPoint& corner : piece.corners) {
        if (corner.triangle < 0) corner = bounds_.measure(corner.point, warm, piece.source, 0);
        warm = corner.triangle;
    }
    for (const MeasuredPoint& corner : piece.corners) bound_by(piece, corner.triangle);
    left_on_b_ += counters_.point_triangle_distances - before;
}

// Calls visit(S, squared distances to the corners) for each triangle S of B that may be within `reach` - r of the piece, r the largest
// distance of a corner from its barycentre c. Let p be in the piece: d(c, S) <= d(p, S) + r, as balls are convex.
template <class Tree>
template <class Visit>
void Search<Tree>::near_triangles(const Piece& piece, const double& reach, const Visit& visit) {
    const std::array<Vec3, 3> points{piece.corners[0].point, piece.corners[1].point, piece.corners[2].point};
    const Vec3 centre = barycentre(piece.corners);
    visit_near_leaves(*b_tree_, centre, reach, counters_, [&](std::size_t leaf) {
        double squared[3][leaf_capacity];
        // A computed squared distance exceeds the exact one by 5u of it at most.
        unsigned mask = b_tree_->leaf_distances(leaf, points, centre, reach * reach * (1 + 8 * unit_roundoff), squared);
        for (; mask != 0; mask &= mask - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(mask));
            visit(b_tree_->tree().leaf(leaf)[i], std::array<double, 3>{squared[0][i], squared[1][i], squared[2][i]});
        }
    });
}

// Finds what is not known yet of its corners, its upper bound and its list.
template <class Tree> void Search<Tree>::cull_on_b(Piece& piece) {
    const Vec3 centre = barycentre(piece.corners);
    double radius = 0;
    for (const MeasuredPoint& corner : piece.corners) radius = std::max(radius, squared_length(corner.point - centre));
    radius = distance_at_most(radius, true) + slack(piece.level);
    const auto known =
        std::array{piece.corners[0].triangle >= 0, piece.corners[1].triangle >= 0, piece.corners[2].triangle >= 0};
    double reach = next_up(piece.upper + radius), least = infinity;
    near_.clear();
    std::uint64_t tested = 0;
    near_triangles(piece, reach, [&](Index triangle, const std::array<double, 3>& squared) {
        ++tested;
        double most = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            MeasuredPoint& corner = piece.corners[k];
            most = std::max(most, squared[k]);
            if (known[k]) continue;
            if (corner.triangle < 0 || squared[k] < corner.squared ||
                (squared[k] == corner.squared && triangle < corner.triangle))
                corner.squared = squared[k], corner.triangle = triangle;
        }
        if (near_.size() <= most_near) near_.push_back({triangle, squared});
        if (!(most < least)) return;
        least = most;
        const double upper = bounds_.at_most(least, piece.level);
        if (upper < piece.upper) piece.upper = upper, piece.best = triangle;
        reach = next_up(piece.upper + radius);
    });
    piece.crowd = tested;
    counters_.point_triangle_distances += 3 * tested;
    counters_.bound_tests += tested;
    if (piece.depth == 0) left_on_b_ += tested;
    for (std::size_t k = 0; k < 3; ++k) {
        if (!known[k]) bounds_.offer(piece.corners[k], piece.source, piece.level);
    }
}

// Keeps what may be nearest to a point of the piece; nothing if that is too much.
template <class Tree> void Search<Tree>::list(Piece& piece) {
    const auto& v = piece.corners;
    std::array<double, 3> squared_edge{}, most{};
    for (std::size_t k = 0; k < 3; ++k) squared_edge[k] = squared_length(v[(k + 1) % 3].point - v[(k + 2) % 3].point);
    for (std::size_t k = 0; k < 3; ++k) {
        const double edge = std::sqrt(std::max(squared_edge[(k + 1) % 3], squared_edge[(k + 2) % 3]));
        const double reach = (piece.upper + edge) * (1 + 8 * unit_roundoff) + slack(piece.level);
        most[k] = reach * reach;
    }
    std::array<Index, most_listed> kept;
    std::size_t count = 0;
    if (near_.size() > most_near) return;
    for (const Near& one : near_) {
        if (one.squared[0] > most[0] || one.squared[1] > most[1] || one.squared[2] > most[2]) continue;
        if (count == most_listed) return;
        kept[count++] = one.triangle;
    }
    piece.list = lists_.store(std::span(kept).first(count));
}

template <class Tree> void Search<Tree>::push(const Piece& piece) {
    if (settle(piece)) return;
    ++counters_.queue_pushes;
    queue_.push(piece);
}

template <class Tree>
template <class Measure>
Cut<MeasuredPoint> Search<Tree>::cut_piece(const PieceCorners& corners, bool voronoi, const Measure& measure) const {
    if (choices_.cutting == Cutting::longest_edge) return cut_triangle(corners, Split::longest_edge, measure);
    if (!voronoi) return cut_triangle(corners, Split::midpoint, measure);
    const auto place = [&](const MeasuredPoint& one, const MeasuredPoint& two) {
        double t = 0.5;
        if (one.triangle != two.triangle)
            t = voronoi_place(one.point, two.point, target_.triangle(one.triangle), target_.triangle(two.triangle),
                              choices_.least_part);
        return point_of_edge(one.point, two.point, t);
    };
    return cut_in_four(corners, place, measure);
}

// Of its parts.
template <class Tree> int Search<Tree>::level_of_cut(const Piece& piece, bool voronoi) const {
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 edge = piece.corners[k].point - piece.corners[(k + 1) % 3].point;
        longest = std::max(longest, edge.cwiseAbs().maxCoeff());
    }
    return piece.level + (voronoi ? level_of_point_of_edge(longest, magnitude_) : 1);
}

// The triangles of B that its parts are bounded by: its list; without one, what is nearest to the vertices.
template <class Tree> Candidates Search<Tree>::candidates(const Piece& piece, const Cut<MeasuredPoint>& cut) const {
    Candidates result;
    for (const Index triangle : lists_.numbers(piece.list)) result.add(triangle);
    if (result.count > 0) return result;
    result.add(piece.best);
    for (std::size_t v = 0; v < cut.vertex_count; ++v) {
        const auto end = result.triangle.begin() + static_cast<std::ptrdiff_t>(result.count);
        if (std::find(result.triangle.begin(), end, cut.vertices[v].triangle) == end)
            result.add(cut.vertices[v].triangle);
    }
    return result;
}

// Measures each candidate against all vertices. Those that are not measured yet are nearest to one of the list.
template <class Tree> void Search<Tree>::measure(Candidates& candidates, Cut<MeasuredPoint>& cut) {
    PointBlock block;
    for (std::size_t lane = 0; lane < block_width; ++lane) {
        const Vec3& point = cut.vertices[std::min(lane, cut.vertex_count - 1)].point;
        for (int k = 0; k < 3; ++k) block.coordinate[k][lane] = point[k];
    }
    std::array<bool, 6> open{};
    for (std::size_t v = 0; v < cut.vertex_count; ++v) open[v] = cut.vertices[v].triangle < 0;
    for (std::size_t s = 0; s < candidates.count; ++s) {
        const Index triangle = candidates.triangle[s];
        target_.squared_distances(block, cut.vertex_count, target_.triangle(triangle), candidates.feet[s]);
        for (std::size_t v = 3; v < cut.vertex_count; ++v) {
            MeasuredPoint& vertex = cut.vertices[v];
            const double squared = candidates.feet[s].squared_distance[v];
            if (open[v] && (s == 0 || squared < vertex.squared)) vertex = {vertex.point, squared, triangle};
        }
    }
    counters_.point_triangle_distances += candidates.count * cut.vertex_count;
    counters_.bound_tests += candidates.count * cut.piece_count;
}

template <class Tree> void Search<Tree>::split(Piece piece) {
    if (piece.list.count == 0 && piece.crowd <= most_near) {
        cull_on_b(piece);
        if (settle(piece)) return;
        list(piece);
    }
    ++counters_.subdivisions;
    const int depth = piece.depth + 1;
    const bool voronoi = choices_.cutting == Cutting::voronoi && depth <= voronoi_depth;
    const int level = level_of_cut(piece, voronoi);
    const bool listed = piece.list.count > 0;
    deepest_ = std::max(deepest_, depth);
    if (elements_) elements_->subdivided(piece.source, depth);
    auto cut = cut_piece(piece.corners, voronoi, [&](const Vec3& point, const MeasuredPoint& near) {
        return listed ? MeasuredPoint{point} : bounds_.measure(point, near.triangle, piece.source, level);
    });
    Candidates found = candidates(piece, cut);
    lists_.give_back(piece.list);
    measure(found, cut);
    for (std::size_t v = 3; v < cut.vertex_count && listed; ++v) bounds_.offer(cut.vertices[v], piece.source, level);
    for (std::size_t c = 0; c < cut.piece_count; ++c) {
        Piece part{cut.corners(c), piece.upper, piece.source, piece.best,
                   level,          depth,       {},           piece.crowd / cut.piece_count};
        near_.clear();
        double least = infinity;
        for (std::size_t s = 0; s < found.count; ++s) {
            const double* squared = found.feet[s].squared_distance;
            const auto& v = cut.pieces[c];
            near_.push_back({found.triangle[s], {squared[v[0]], squared[v[1]], squared[v[2]]}});
            const double most = std::max({squared[v[0]], squared[v[1]], squared[v[2]]});
            if (most < least) least = most, part.best = found.triangle[s];
        }
        part.upper = std::min(part.upper, bounds_.at_most(least, level));
        if (settle(part)) continue;
        if (listed) list(part);
        push(part);
    }
}

template <class Tree> void Search<Tree>::begin_warm() {
    const WarmStart& last = *warm_start_;
    if (last.source < 0) return;
    const Triangle triangle = posed_triangle(last.source);
    if (last.corner < 0) {
        bounds_.measure(last.point_in(triangle), last.target, last.source, level_of_closest_point);
    } else {
        const Index v = a_.triangles(last.source, last.corner);
        vertices_[static_cast<std::size_t>(v)] = bounds_.measure(points_.row(v), last.target, last.source, 0);
    }
}

template <class Tree> Result Search<Tree>::search() {
    if (warm_start_) begin_warm();
    const std::optional<Status> stopped = cull_on_a();
    stages_.end("cull");
    if (stopped) {
        const double rest = branches_.empty() ? 0 : branches_.back().rest;
        return bounds_.result(*stopped, std::max(rest, queue_.upper()));
    }
    while (true) {
        if (const auto status = bounds_.end(queue_.upper(), counters_.subdivisions)) {
            stages_.end("subdivide");
            return bounds_.result(*status, queue_.upper());
        }
        const Piece piece = queue_.pop();
        if (!settle(piece))  // the lower bound may be larger than when it was pushed
            split(piece);
        else
            lists_.give_back(piece.list);
    }
}

template <class Tree> class Tang final : public MeshSolver<Tree> {
public:
    explicit Tang(const Choices& choices) : choices_(choices) {}

    // However small the shapes are: culling goes by the nodes.
    Needs needs(const Scene&, const QuerySet&) const override {
        return {need<Tree>(Side::source), need<Tree>(Side::target)};
    }

    void prepare(const Scene& scene, const Prepared& prepared) override {
        MeshSolver<Tree>::prepare(scene, prepared);
        a_tree_ = &prepared.get<Tree>(Side::source);
    }

    std::unique_ptr<State> begin() const override { return std::make_unique<WarmStart>(); }

private:
    Result search(const MeshPair& pair, const Query& query, State* state, Trace& trace) const override {
        return Search<Tree>(pair, a_tree_, this->tree(), query, static_cast<WarmStart*>(state), trace, choices_).run();
    }

    Choices choices_;
    const Tree* a_tree_ = nullptr;
};

std::unique_ptr<Solver> make(const Options& options) {
    const std::string split = options.text("split"), volumes = options.text("volumes");
    const Choices choices{split == "voronoi"    ? Cutting::voronoi
                          : split == "midpoint" ? Cutting::midpoint
                                                : Cutting::longest_edge,
                          options.flag("group"), options.real("least_part")};
    if (volumes == "boxes") return std::make_unique<Tang<TriangleBvh>>(choices);
    return std::make_unique<Tang<SweptSphereBvh>>(choices);
}

}  // namespace

SolverEntry tang_solver() {
    SolverInfo info = mesh_solver_info<SweptSphereBvh>("tang", "Tang et al.", "tang2009");
    info.warm = true;
    info.may_need = {need<SweptSphereBvh>(Side::source), need<SweptSphereBvh>(Side::target),
                     need<TriangleBvh>(Side::source), need<TriangleBvh>(Side::target)};
    info.parameters = {
        {.name = "volumes",
         .default_value = std::string("swept_spheres"),
         .unit = "",
         .paper_value = "swept_spheres",
         .description = "of the nodes of both BVHs",
         .choices = {"swept_spheres", "boxes"}},
        {.name = "group",
         .default_value = true,
         .unit = "",
         .paper_value = "true",
         .description = "the three corners of a triangle of A go through the BVH of B together; off: each by itself",
         .choices = {}},
        {.name = "split",
         .default_value = std::string("voronoi"),
         .unit = "",
         .paper_value = "voronoi",
         .description =
             "how a piece of A is cut: four pieces, where the edges are as far from the one triangle of B as "
             "from another, or at their midpoints; or two, at the midpoint of the longest edge, for needles",
         .choices = {"voronoi", "midpoint", "longest_edge"}},
        {.name = "least_part",
         .default_value = 0.25,
         .unit = "edges",
         .paper_value = "",
         .description = "a Voronoi cut leaves at least this part of an edge on either side",
         .choices = {},
         .least = 0.01,
         .most = 0.5},
    };
    return {info, make};
}

}  // namespace hausbench
