#include "harness/record/fields.h"

#include "algorithms/error.h"
#include "algorithms/kernel/point_triangle.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/triangle.h"
#include "algorithms/structures/bvh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace hausbench {

namespace {

Points standing(const PreparedShape& shape, const Pose& pose, const char* name) {
    if (kind_of(shape.shape()) == ShapeKind::surface)
        throw InputError("an algebraic surface has no vertices, so it has no fields: triangulate it first");
    Points points = posed(shape.original(), pose);
    if (points.allFinite()) return points;
    throw InputError(std::string("the pose moves a point of ") + name +
                     " beyond the largest double, 1.8e308: give both shapes in a larger unit");
}

constexpr double longest_edge = 1.0 / 64;  // of the diagonal of A

// Distances of points to B, in the unit of B.
class DistanceTo {
public:
    explicit DistanceTo(const PreparedShape& target) : tree_(target.triangles()) {}

    struct Found {
        double distance;
        Index element;
    };
    // `near`: an element of B that is probably near, or -1.
    Found operator()(const Vec3& p, Index near) const {
        Counters unused;
        ClosestHints hints;
        hints.warm_triangle = near;
        const ClosestPoint found = tree_.closest(p, hints, unused);
        return {std::sqrt(found.squared_distance), found.triangle};
    }

private:
    TriangleBvh tree_;
};

// Bisects edges that were marked, and with each edge the longest edge of every piece that has it, so that pieces become no thinner than
// half of the angles of A (Rivara 1984). Neighbours share the mark of their edge, so no gap opens between them. Lengths are scaled.
class FieldCutter {
public:
    // `floor`: differences and lengths up to it are left to rounding.
    FieldCutter(const Points& vertices, const Triangles& triangles, const DistanceTo& distance_to, double floor,
                std::size_t most_pieces)
        : distance_to_(distance_to),
          floor_(floor),
          longest_(std::max(floor, longest_edge * diagonal(vertices))),
          most_(std::max(most_pieces, static_cast<std::size_t>(triangles.rows()))) {
        for (Index i = 0; i < vertices.rows(); ++i) add(vertices.row(i).transpose(), i > 0 ? nearest.back() : -1);
        pieces.reserve(static_cast<std::size_t>(triangles.rows()));
        for (Index t = 0; t < triangles.rows(); ++t)
            pieces.push_back({{triangles(t, 0), triangles(t, 1), triangles(t, 2)}, t, false});
    }

    struct Piece {
        std::array<Index, 3> corners;
        Index element;
        bool settled;  // its edges and its centroid were compared
    };
    std::vector<Vec3> points;
    std::vector<double> distances;
    std::vector<Index> nearest;
    std::vector<Piece> pieces;

    void insert(const Vec3& p, Index element) {
        Piece& whole = pieces[static_cast<std::size_t>(element)];
        const auto [a, b, c] = whole.corners;
        const Index middle = add(p, nearest[static_cast<std::size_t>(a)]);
        whole.corners = {a, b, middle};
        pieces.push_back({{b, c, middle}, element, false});
        pieces.push_back({{c, a, middle}, element, false});
    }

    // Cuts to this resolution. Returns whether nothing is left to cut.
    bool cut(double resolution) {
        resolution_ = std::max(resolution, floor_);
        while (true) {
            const auto wanted = compare_unsettled();
            if (wanted.empty()) return true;
            list_edges();
            marks_.clear();
            bool all = true;
            for (const auto& [off, edge] : wanted) all = all && mark(edge);
            for (auto& [edge, middle] : marks_) middle = add(midpoint(edge), nearest[edge >> 32]);
            split();
            if (!all) return false;
        }
    }

private:
    using Edge = std::uint64_t;  // its two vertices

    Index add(const Vec3& p, Index near) {
        const auto found = distance_to_(p, near);
        points.push_back(p);
        distances.push_back(found.distance);
        nearest.push_back(found.element);
        return static_cast<Index>(points.size() - 1);
    }

    static Edge edge_of(const Piece& piece, int k) {
        const auto a = static_cast<Edge>(piece.corners[k]), b = static_cast<Edge>(piece.corners[(k + 1) % 3]);
        return std::min(a, b) << 32 | std::max(a, b);
    }

    Vec3 midpoint(Edge edge) const { return (points[edge >> 32] + points[edge & 0xffffffff]) / 2; }
    double squared_length_of(Edge edge) const { return squared_length(points[edge >> 32] - points[edge & 0xffffffff]); }

    // Breaks ties by the larger number, so that following longer and longer edges ends.
    int longest_of(const Piece& piece) const {
        int best = 0;
        std::pair<double, Edge> most{-1, 0};
        for (int k = 0; k < 3; ++k) {
            const std::pair<double, Edge> one{squared_length_of(edge_of(piece, k)), edge_of(piece, k)};
            if (one > most) {
                most = one;
                best = k;
            }
        }
        return best;
    }

    // Edges to bisect, the largest difference first. Every piece is settled then.
    std::vector<std::pair<double, Edge>> compare_unsettled() {
        std::vector<std::pair<double, Edge>> wanted;
        std::vector<Edge> edges;
        for (Piece& piece : pieces) {
            if (piece.settled) continue;
            piece.settled = true;
            for (int k = 0; k < 3; ++k) edges.push_back(edge_of(piece, k));
            const double off = off_at_centroid(piece);
            if (off > resolution_ || is_long(piece)) wanted.emplace_back(off, edge_of(piece, longest_of(piece)));
        }
        std::sort(edges.begin(), edges.end());
        edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
        for (const Edge edge : edges) {
            const double off = off_at_midpoint(edge);
            if (off > resolution_) wanted.emplace_back(off, edge);
        }
        std::sort(wanted.begin(), wanted.end(), std::greater<>());
        return wanted;
    }

    // Excludes needles: cutting one makes more needles.
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

    void list_edges() {
        pieces_of_.clear();
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            for (int k = 0; k < 3; ++k) pieces_of_.emplace_back(edge_of(pieces[i], k), i);
        }
        std::sort(pieces_of_.begin(), pieces_of_.end());
        due_ = 0;
    }

    // Marks the edge and those that have to be bisected with it. Not if that takes too many pieces: it then returns false.
    bool mark(Edge first) {
        std::vector<Edge> open{first}, fresh;
        std::size_t more = 0;  // pieces: as many as share the edge
        while (!open.empty()) {
            const Edge edge = open.back();
            open.pop_back();
            if (!marks_.try_emplace(edge, -1).second) continue;
            fresh.push_back(edge);
            const std::pair<Edge, std::size_t> from{edge, 0};
            for (auto at = std::lower_bound(pieces_of_.begin(), pieces_of_.end(), from);
                 at != pieces_of_.end() && at->first == edge; ++at) {
                ++more;
                const Piece& piece = pieces[at->second];
                open.push_back(edge_of(piece, longest_of(piece)));
            }
        }
        if (pieces.size() + due_ + more > most_) {
            for (const Edge edge : fresh) marks_.erase(edge);
            return false;
        }
        due_ += more;
        return true;
    }

    // From the middle of its longest edge, each piece is cut to the corner across and to the middles of its other marked edges.
    void split() {
        const std::size_t count = pieces.size();
        for (std::size_t i = 0; i < count; ++i) {
            const Piece whole = pieces[i];
            const int k = longest_of(whole);
            const auto middle_of = [&](int edge) {
                const auto at = marks_.find(edge_of(whole, edge % 3));
                return at == marks_.end() ? -1 : at->second;
            };
            const Index hub = middle_of(k);
            if (hub < 0) continue;
            const Index corners[] = {whole.corners[(k + 1) % 3], whole.corners[(k + 2) % 3], whole.corners[k]};
            std::vector<Index> way{corners[0]};  // from the end of the longest edge round to its begin
            for (int step = 0; step < 2; ++step) {
                if (const Index middle = middle_of(k + 1 + step); middle >= 0) way.push_back(middle);
                way.push_back(corners[step + 1]);
            }
            pieces[i] = {{hub, way[0], way[1]}, whole.element, false};
            for (std::size_t j = 1; j + 1 < way.size(); ++j)
                pieces.push_back({{hub, way[j], way[j + 1]}, whole.element, false});
        }
    }

    const DistanceTo& distance_to_;
    double floor_, longest_, resolution_ = 0;
    std::size_t most_, due_ = 0;                           // pieces; due_: that the marks add
    std::vector<std::pair<Edge, std::size_t>> pieces_of_;  // each edge with each of its pieces, sorted
    std::unordered_map<Edge, Index> marks_;                // with the vertex in the middle
};

}  // namespace

double DrawnField::largest() const { return *std::max_element(distances.begin(), distances.end()); }

DrawnField draw_distance(const PreparedShape& source, const Pose& source_pose, const PreparedShape& target,
                         const Pose& target_pose, const Drawing& drawing) {
    const Points here = standing(source, source_pose, "A");
    Shape there = target.shape();
    points_of(there) = standing(target, target_pose, "B");
    const double largest = std::max(magnitude(here), magnitude(points_of(there)));
    const int exponent = scale_exponent(largest);
    const PreparedShape from(PointSet{here}, exponent), to(std::move(there), exponent);
    const Shape& whole = source.shape();
    const auto* mesh = std::get_if<TriangleMesh>(&whole);
    const DistanceTo distance_to(to);
    const double floor = std::ldexp(4 * field_error(largest), exponent);  // never cuts because of rounding
    FieldCutter cutter(points_of(from.shape()), mesh ? mesh->triangles : Triangles(0, 3), distance_to, floor,
                       drawing.most_pieces);
    DrawnField drawn;
    if (mesh && std::isfinite(drawing.fraction)) {
        const double farthest = *std::max_element(cutter.distances.begin(), cutter.distances.end());
        const Vec3 witness = drawing.witness.unaryExpr([&](double x) { return std::ldexp(x, exponent); });
        const Index element = drawing.witness_element;
        if (element >= 0 && element < mesh->triangles.rows() && witness.allFinite()) {
            const TriangleMesh scaled{points_of(from.shape()), mesh->triangles.row(element)};
            const double off = std::sqrt(closest_point(witness, triangle_of(scaled, 0)).squared_distance);
            if (off <= field_error(std::ldexp(largest, exponent))) cutter.insert(witness, element);
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
        drawn.distances.push_back(std::ldexp(cutter.distances[static_cast<std::size_t>(i)], -exponent));
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

void add_own(Fields& fields, Fields own) {
    constexpr std::string_view taken[] = {"distance", "nearest", "x", "y", "z", "a", "b", "c", "element"};
    for (Field& field : own) {
        if (std::find(std::begin(taken), std::end(taken), field.name) != std::end(taken))
            field.name = "own " + field.name;
        fields.push_back(std::move(field));
    }
}

// Places of vertices that cuts add. The midpoint of two vertices is rounded by sqrt(3) uM and is off its triangle by
// that and the mean error of the two. A piece is cut only if its longest edge is longer than the resolution, which is
// at least 1280uM: some 44 cuts lie behind a vertex, 77uM. A witness is off by at most field_error(M), 320uM.
//
// Distances. Both shapes are scaled by a power of two, so that M is in [0.5, 1): coordinates that underflow are off by 2^-1075, next to uM nothing,
// and the distance by as much when it is scaled back.
//
// Let p be a vertex, T = abc a triangle with its longest edge e = b - a first, d the distance from p to T, q the point that closest_point
// (point_triangle.h) returns. q is within 7uM of T, so |p - q| >= d - 7uM. Here is the other side: |p - q| <= d + 271uM. The largest
// that was found is 10uM. Lengths are at most S = 2 sqrt(3) M < 3.47M; terms of order u^2 are in what constants are rounded up by.
//
// 1. Dot products of two computed differences err by 5.1u times both lengths, squares of lengths by 5.1u of themselves, their inverses by
//    6.2u. So along * inverse, for the point of an edge of length l that is nearest to p, errs by 12.4uS / l, which moves the point by
//    12.4uS, and rounding it by 6uM: it is within d_edge + 49.1uM of p. If l < 2^-500, where squares underflow, any point of the edge is
//    that near. The same holds of T if the point of T nearest to p is on an edge. Otherwise let it be a + X e + Y h, h the height over e.
// 2. |h| <= 46uS, a needle: the line along h through that point has at most |h| of it in T, so an edge is nearer to it than 80uM, and
//    step 1 finds a point within d + 80uM + 49.1uM.
// 3. |h| > 46uS. x_c errs by 12.4u, f - x_c e is rounded by 4.1u|e|: it is off by 4.1u|e| across e, and by 16.5u|e| along e. The second
//    step leaves 5.3u|h| + 230u^2|e| < 10.3u|h| along e, and 5.2u|e| =: b < 0.113|h| across. In y = h.ap / h.h, times |h|:
//       6u|e|             from b in the plane of T, where ap has Y|h| along h
//       13.1u|e|          from what is left along e, where ap has X|e|
//       r = 6.7ud|e|/|h|  from b out of the plane, where ap has d: the tilt
//       9.5uS             from rounding the two dot products and the quotient
//    and in x + y x_c, times |e|: 12.4uS from step 1, 12.4uy|e| from x_c, 2.1uS from the product and the difference.
// 4. If the weights are accepted, y <= 1, and the foot is off by 26.9uS along e and 28.6uS + r along h. No two points of T are farther
//    apart along h than |h|, so r counts as r' <= min(r, |h|), and sqrt(d^2 + r'^2) <= d + r|h| / 2d < d + 3.4uS. With the 7uM of the
//    rounded point |p - q| <= d + 42.7uS + 7uM < d + 156uM.
// 5. If they are refused, the foot as computed is outside, and a part s of the way to it from the exact one is on an edge. As s|y - Y| <= 1,
//    that is s y <= 2, the way so far is 42.4uS along e at most, and as before along h: an edge is within d + 54.6uS of p, and step 1 finds
//    a point within d + 54.6uS + 49.1uM < d + 239uM.
// 6. The smallest of the computed squares wins, which err by 7.1u of each other's roots, 25uM; then q is moved into the box of T, by no
//    more than it is off T: 239 + 25 + 7 = 271.
//
// Over all triangles the smallest computed square wins once more, 25uM, and its triangle is within 7uM of q: 303uM. The distance is
// computed with an error of 4u, 14uM, which is less. 320uM is more than all of it. Coordinates and distances that are scaled back to subnormals are off by less than 2^-1072.
double field_error(double magnitude) { return 320 * unit_roundoff * magnitude + 0x1p-1072; }

std::string_view to_string(Field::Of of) {
    constexpr std::string_view names[] = {"vertices", "elements", "pieces"};
    return names[static_cast<std::size_t>(of)];
}

std::string_view to_string(Field::Meaning meaning) {
    constexpr std::string_view names[] = {"lower", "upper", "number"};
    return names[static_cast<std::size_t>(meaning)];
}

}  // namespace hausbench
