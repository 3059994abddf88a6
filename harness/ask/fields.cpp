#include "harness/ask/fields.h"

#include "algorithms/error.h"
#include "algorithms/kernel/point_triangle.h"
#include "algorithms/kernel/triangle.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/structures/bvh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <numeric>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace hausbench {
namespace {

Points standing(const PreparedShape& shape, const Pose& pose, const char* name) {
    if (kind_of(shape.shape()) == ShapeKind::surface)
        throw InputError("an algebraic surface has no vertices, so it has no fields: triangulate it first");
    Points points = posed(
        WATCHED_ELSE("fields: the coordinates before they were scaled", shape.original(), points_of(shape.shape())),
        WATCHED_ELSE("fields: the poses of both shapes", pose, Pose{}));
    if (points.allFinite()) return points;
    throw InputError(std::string("the pose moves a point of ") + name +
                     " beyond the largest double, 1.8e308: give both shapes in a larger unit");
}

constexpr double longest_edge = 1.0 / 64;  // as a fraction of the diagonal of A

// Finds the distance from a point to B, and the nearest element of B.
class DistanceTo {
public:
    explicit DistanceTo(const PreparedShape& target) : tree_(target.triangles()) {}

    struct Found {
        double distance;
        Index element;
    };
    // `near` is an element of B that is probably near p, or -1.
    Found operator()(const Vec3& p, Index near) const {
        Counters unused;
        ClosestHints hints;
        hints.warm_triangle = near;
        const ClosestPoint nearest = tree_.closest(p, hints, unused);
        return {std::sqrt(nearest.squared_distance), nearest.triangle};
    }

private:
    TriangleBvh tree_;
};

// Cuts A into pieces by bisecting edges. Bisecting an edge also bisects the longest edge of every piece that shares it,
// which keeps every angle at least half as large as the smallest angle of A (Rivara 1984). Neighbours share an edge and
// its midpoint, so no gap opens between them.
class FieldCutter {
public:
    // Interpolation errors and lengths up to `floor` cause no cuts, because they may be rounding errors.
    FieldCutter(const Points& vertices, const Triangles& triangles, const DistanceTo& distance_to, double floor,
                std::size_t most_pieces, const Deadline& deadline)
        : distance_to_(distance_to),
          floor_(floor),
          longest_(std::max(floor, longest_edge * diagonal(vertices))),
          most_(std::max(most_pieces, static_cast<std::size_t>(triangles.rows()))) {
        for (Index i = 0; i < vertices.rows(); ++i) {
            late_ = late_ || (i % 8 == 0 && deadline.passed());
            add(vertices.row(i).transpose(), i > 0 ? nearest.back() : -1);
        }
        pieces.reserve(static_cast<std::size_t>(triangles.rows()));
        for (Index t = 0; t < triangles.rows(); ++t)
            pieces.push_back({{triangles(t, 0), triangles(t, 1), triangles(t, 2)}, t});
    }

    struct Piece {
        std::array<Index, 3> corners;
        Index element;
    };
    std::vector<Vec3> points;
    std::vector<double> distances;
    std::vector<Index> nearest;
    std::vector<Piece> pieces;

    // Cuts a triangle of A into three pieces that meet at p, a new vertex.
    void insert(const Vec3& p, Index element) {
        Piece& whole = pieces[static_cast<std::size_t>(element)];
        const auto [a, b, c] = whole.corners;
        const Index middle = add(p, nearest[static_cast<std::size_t>(a)]);
        whole.corners = {a, b, middle};
        pieces.push_back({{b, c, middle}, element});
        pieces.push_back({{c, a, middle}, element});
    }

    // Cuts until the distance differs from its linear interpolation by at most `resolution` everywhere it is compared.
    // Returns false if the limit on pieces ended the cutting before.
    bool cut(double resolution) {
        resolution_ = std::max(resolution, floor_);
        unsettled_.resize(pieces.size());
        std::iota(unsettled_.begin(), unsettled_.end(), std::size_t{0});
        while (true) {
            const auto wanted = compare_unsettled();
            if (wanted.empty()) return true;
            list_edges();
            due_ = 0;
            marks_.clear();
            bool all = true;
            for (const auto& [off, edge] : wanted) all = all && mark(edge);
            for (auto& [edge, middle] : marks_) middle = add(midpoint(edge), nearest[edge >> 32]);
            split();
            if (!all) return false;
        }
    }

private:
    using Edge = std::uint64_t;  // the numbers of its two vertices: the smaller one times 2^32, plus the larger one

    Index add(const Vec3& p, Index near) {
        const auto closest = late_ ? DistanceTo::Found{infinity, -1} : distance_to_(p, near);
        points.push_back(p);
        distances.push_back(closest.distance);
        nearest.push_back(closest.element);
        return static_cast<Index>(points.size() - 1);
    }

    static Edge edge_of(const Piece& piece, int k) {
        const auto a = static_cast<Edge>(piece.corners[k]), b = static_cast<Edge>(piece.corners[(k + 1) % 3]);
        return std::min(a, b) << 32 | std::max(a, b);
    }

    Vec3 midpoint(Edge edge) const { return (points[edge >> 32] + points[edge & 0xffffffff]) / 2; }
    double squared_length_of(Edge edge) const { return squared_length(points[edge >> 32] - points[edge & 0xffffffff]); }

    // Returns which of the edges 0, 1, 2 is the longest. Ties go to the largest Edge, so that mark(), which goes from
    // an edge to the longest edges of its pieces, cannot go in circles.
    int longest_of(const Piece& piece) const {
        int best = 0;
        std::pair<double, Edge> most{-1, 0};
        for (int k = 0; k < 3; ++k) {
            const std::pair<double, Edge> candidate{squared_length_of(edge_of(piece, k)), edge_of(piece, k)};
            if (candidate > most) {
                most = candidate;
                best = k;
            }
        }
        return best;
    }

    // Compares the distance with its linear interpolation on all pieces that are new since the last call. Returns the
    // edges to bisect, the largest difference first.
    std::vector<std::pair<double, Edge>> compare_unsettled() {
        std::vector<std::pair<double, Edge>> wanted;
        std::vector<Edge> edges;
        std::sort(unsettled_.begin(), unsettled_.end());
        for (const std::size_t i : std::exchange(unsettled_, {})) {
            const Piece& piece = pieces[i];
            for (int k = 0; k < 3; ++k) edges.push_back(edge_of(piece, k));
            const double off = off_at_centroid(piece);
            if (WATCHED("fields: centroids of pieces are compared", off > resolution_) || is_long(piece))
                wanted.emplace_back(off, edge_of(piece, longest_of(piece)));
        }
        std::sort(edges.begin(), edges.end());
        edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
        for (const Edge edge : edges) {
            const double off = off_at_midpoint(edge);
            if (WATCHED("fields: midpoints of edges are compared", off > resolution_)) wanted.emplace_back(off, edge);
        }
        WATCHED_ELSE("fields: the largest differences first", std::sort(wanted.begin(), wanted.end(), std::greater<>()),
                     std::sort(wanted.begin(), wanted.end()));
        return wanted;
    }

    // Returns whether a piece is too long. A thin piece, whose height is at most the resolution, is never too long,
    // because cutting it only makes more thin pieces.
    bool is_long(const Piece& piece) const {
        const double squared = squared_length_of(edge_of(piece, longest_of(piece)));
        const auto corner = [&](int k) { return points[static_cast<std::size_t>(piece.corners[k])]; };
        const double twice_area = (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
        return squared > longest_ * longest_ && twice_area > resolution_ * std::sqrt(squared);
    }

    double off_at_midpoint(Edge edge) const {
        const std::size_t a = edge >> 32, b = edge & 0xffffffff;
        return std::abs(distance_to_(midpoint(edge), nearest[a]).distance - (distances[a] + distances[b]) / 2);
    }

    double off_at_centroid(const Piece& piece) const {
        Vec3 centroid = Vec3::Zero();
        double mean = 0;
        for (Index corner : piece.corners) {
            centroid += points[static_cast<std::size_t>(corner)] / 3;
            mean += distances[static_cast<std::size_t>(corner)] / 3;
        }
        const Index near = nearest[static_cast<std::size_t>(piece.corners[0])];
        return std::abs(distance_to_(centroid, near).distance - mean);
    }

    static bool has(const Piece& piece, Edge edge) {
        return edge_of(piece, 0) == edge || edge_of(piece, 1) == edge || edge_of(piece, 2) == edge;
    }

    // Lists the pieces at each edge anew, unless few have changed since the last time. A round may cut very few: A may be
    // thin where the differences are, so that they shrink slowly.
    void list_edges() {
        if (!listed_.empty() && changed_ <= pieces.size() / 8) return;
        listed_.clear();
        changed_at_.clear();
        changed_ = 0;
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            for (int k = 0; k < 3; ++k) listed_.emplace_back(edge_of(pieces[i], k), i);
        }
        std::sort(listed_.begin(), listed_.end());
    }

    // Notes that a piece is new or has other corners than before.
    void change(std::size_t i) {
        unsettled_.push_back(i);
        if (++changed_ > pieces.size() / 8) return;  // all are listed anew before the next round
        for (int k = 0; k < 3; ++k) changed_at_[edge_of(pieces[i], k)].push_back(i);
    }

    // Returns the pieces at an edge, in order.
    std::vector<std::size_t> pieces_at(Edge edge) const {
        std::vector<std::size_t> indices;
        for (auto at = std::lower_bound(listed_.begin(), listed_.end(), std::pair<Edge, std::size_t>{edge, 0});
             at != listed_.end() && at->first == edge; ++at)
            if (has(pieces[at->second], edge)) indices.push_back(at->second);
        const auto at = changed_at_.find(edge);
        if (at == changed_at_.end()) return indices;
        for (const std::size_t i : at->second)
            if (has(pieces[i], edge)) indices.push_back(i);
        std::sort(indices.begin(), indices.end());
        indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
        return indices;
    }

    // Marks an edge for bisection, and the longest edges that must be bisected with it. If this would exceed the limit
    // on pieces, marks nothing and returns false.
    bool mark(Edge first) {
        std::vector<Edge> open{first}, fresh;
        std::vector<std::size_t> here;
        std::size_t more = 0;  // new pieces: bisecting an edge adds one for each piece that has it
        while (!open.empty()) {
            const Edge edge = open.back();
            open.pop_back();
            if (!marks_.try_emplace(edge, -1).second) continue;
            fresh.push_back(edge);
            for (const std::size_t i : pieces_at(edge)) {
                for (int k = 0; k < 3; ++k) more += edge_of(pieces[i], k) == edge ? 1 : 0;  // twice on a segment
                here.push_back(i);
                if (WATCHED("fields: with an edge the longest of its pieces is bisected", true))
                    open.push_back(edge_of(pieces[i], longest_of(pieces[i])));
            }
        }
        if (pieces.size() + due_ + more > most_) {
            for (const Edge edge : fresh) marks_.erase(edge);
            return false;
        }
        due_ += more;
        cut_.insert(cut_.end(), here.begin(), here.end());
        return true;
    }

    // Cuts each piece that has marked edges. The cuts start at the midpoint of its longest edge, which is then marked,
    // too, and go to the opposite corner and to the midpoints of the other marked edges.
    void split() {
        std::sort(cut_.begin(), cut_.end());
        cut_.erase(std::unique(cut_.begin(), cut_.end()), cut_.end());
        for (const std::size_t i : std::exchange(cut_, {})) {
            const Piece whole = pieces[i];
            const int k = longest_of(whole);
            const auto middle_of = [&](int edge) {
                const auto at = marks_.find(edge_of(whole, edge % 3));
                return at == marks_.end() ? -1 : at->second;
            };
            const Index hub = middle_of(k);
            if (hub < 0) continue;
            const Index corners[] = {whole.corners[(k + 1) % 3], whole.corners[(k + 2) % 3], whole.corners[k]};
            std::vector<Index> way{corners[0]};  // the boundary from the end of the longest edge to its start
            for (int step = 0; step < 2; ++step) {
                if (const Index middle = middle_of(k + 1 + step); middle >= 0) way.push_back(middle);
                way.push_back(corners[step + 1]);
            }
            pieces[i] = {{hub, way[0], way[1]}, whole.element};
            change(i);
            for (std::size_t j = 1; j + 1 < way.size(); ++j) {
                pieces.push_back({{hub, way[j], way[j + 1]}, whole.element});
                change(pieces.size() - 1);
            }
        }
    }

    const DistanceTo& distance_to_;
    double floor_, longest_, resolution_ = 0;
    bool late_ = false;                                 // the deadline has passed
    std::size_t most_, due_ = 0;                        // the limit on pieces; how many the marked edges will add
    std::vector<std::pair<Edge, std::size_t>> listed_;  // each edge with each of its pieces, sorted
    std::unordered_map<Edge, std::vector<std::size_t>> changed_at_;  // pieces at each edge that changed since then
    std::size_t changed_ = 0;                                        // how many pieces that were
    std::vector<std::size_t> cut_;                                   // pieces with a marked edge
    std::vector<std::size_t> unsettled_;     // pieces whose differences at the edges and the centroid were not measured
    std::unordered_map<Edge, Index> marks_;  // marked edges, each with the vertex at its midpoint
};

}  // namespace

double DrawnField::largest() const { return *std::max_element(distances.begin(), distances.end()); }

DrawnField draw_distance(const PreparedShape& source, const Pose& source_pose, const PreparedShape& target,
                         const Pose& target_pose, const Drawing& drawing) {
    const Points here = standing(source, source_pose, "A");
    Shape there = target.shape();
    points_of(there) = standing(target, target_pose, "B");
    const double largest = std::max(magnitude(here), magnitude(points_of(there)));
    const int exponent = WATCHED("fields: scaled so that no square overflows", scale_exponent(largest));
    const PreparedShape from(PointSet{here}, exponent), to(std::move(there), exponent);
    const Shape& whole = source.shape();
    const auto* mesh = std::get_if<TriangleMesh>(&whole);
    const DistanceTo distance_to(to);
    const double floor = std::ldexp(4 * field_error(largest), exponent);  // so that rounding causes no cuts
    FieldCutter cutter(points_of(from.shape()), mesh ? mesh->triangles : Triangles(0, 3), distance_to, floor,
                       drawing.most_pieces, drawing.deadline ? *drawing.deadline : Deadline(infinity));
    DrawnField drawn;
    if (mesh && std::isfinite(drawing.fraction)) {
        const double farthest = *std::max_element(cutter.distances.begin(), cutter.distances.end());
        const Vec3 witness = drawing.witness.unaryExpr([&](double x) { return std::ldexp(x, exponent); });
        const Index element = drawing.witness_element;
        if (element >= 0 && element < mesh->triangles.rows() && witness.allFinite()) {
            const TriangleMesh scaled{points_of(from.shape()), mesh->triangles.row(element)};
            const double off = std::sqrt(closest_point(witness, triangle_of(scaled, 0)).squared_distance);
            if (WATCHED_ELSE("fields: a witness that is not on its triangle is no vertex",
                             off <= field_error(std::ldexp(largest, exponent)), off >= 0))
                cutter.insert(witness, element);
        }
        const double lower = std::isfinite(drawing.lower) ? std::ldexp(drawing.lower, exponent) : 0;
        drawn.resolved = cutter.cut(drawing.fraction * std::max(lower, farthest));
    }
    const auto count = static_cast<Index>(cutter.points.size()), pieces = static_cast<Index>(cutter.pieces.size());
    drawn.vertices.resize(count, 3);
    drawn.vertices.topRows(here.rows()) = here;
    for (Index i = 0; i < count; ++i) {
        const Vec3& p = cutter.points[static_cast<std::size_t>(i)];
        for (int k = 0; k < 3 && i >= here.rows(); ++k) drawn.vertices(i, k) = std::ldexp(p[k], -exponent);
        drawn.distances.push_back(std::ldexp(cutter.distances[static_cast<std::size_t>(i)],
                                             WATCHED("fields: distances are scaled back", -exponent)));
    }
    drawn.nearest = std::move(cutter.nearest);
    drawn.pieces.resize(pieces, 3);
    for (Index i = 0; i < pieces; ++i) {
        const FieldCutter::Piece& piece = cutter.pieces[static_cast<std::size_t>(i)];
        for (int k = 0; k < 3; ++k) drawn.pieces(i, k) = piece.corners[k];
        drawn.elements.push_back(piece.element);
    }
    return drawn;
}

Fields as_fields(const DrawnField& drawn) {
    const auto field = [](const char* name, Field::Of of, auto begin, auto end) {
        return Field{name, of, Field::Meaning::number, std::vector<double>(begin, end)};
    };
    Fields fields;
    fields.push_back(field("distance", Field::Of::vertices, drawn.distances.begin(), drawn.distances.end()));
    fields.push_back(field("nearest", Field::Of::vertices, drawn.nearest.begin(), drawn.nearest.end()));
    for (int k = 0; k < 3; ++k) {
        const auto column = drawn.vertices.col(k);
        fields.push_back(field(std::array{"x", "y", "z"}[k], Field::Of::vertices, column.begin(), column.end()));
    }
    if (drawn.pieces.rows() == 0) return fields;
    for (int k = 0; k < 3; ++k) {
        const auto column = drawn.pieces.col(k);
        fields.push_back(field(std::array{"a", "b", "c"}[k], Field::Of::pieces, column.begin(), column.end()));
    }
    fields.push_back(field("element", Field::Of::pieces, drawn.elements.begin(), drawn.elements.end()));
    return fields;
}

void add_own(Fields& fields, Fields solver_fields) {
    constexpr std::string_view taken[] = {"distance", "nearest", "x", "y", "z", "a", "b", "c", "element"};
    for (Field& field : solver_fields) {
        if (std::find(std::begin(taken), std::end(taken), field.name) != std::end(taken))
            field.name = "own " + field.name;
        fields.push_back(std::move(field));
    }
}

std::string_view to_string(Field::Of of) {
    return std::array{"vertices", "elements", "pieces"}[static_cast<std::size_t>(of)];
}

std::string_view to_string(Field::Meaning meaning) {
    return std::array{"lower", "upper", "number"}[static_cast<std::size_t>(meaning)];
}

}  // namespace hausbench
