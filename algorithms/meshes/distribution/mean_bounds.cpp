// Bounds on the distance to B over one piece of A.
//
// Let T be the piece and C a set of triangles of B that has a nearest one for every point of T. d = min over S in C of
// d_S, and every d_S is convex.
//
// Upper bound. d <= d_S for any S, and a convex function is at most the affine function with the same values at the
// corners. S is the triangle nearest to the centre of T.
//
// Lower bound. For any vector n with |n| <= 1, d_S(a) >= n.a - h, where h is the largest n.v over the corners v of S: a
// support plane of S. The minimum of one such plane for each S is concave, so it is at least the affine function with
// the same values at the corners. n is the direction to the centre from its closest point in S, or the direction for
// the triangle nearest to the centre: the latter is exact for triangles in one plane. An error of n makes the plane
// worse, but not wrong.
//
// A triangle S of C whose plane is not below the upper bound at any corner is nowhere nearer than the triangle nearest
// to the centre. Such triangles are left out of kept(), so they do not appear in parts of T again.
//
// Rounding. u = 2^-53, M is the largest |coordinate|.
// - Upper: surface_distance_at_most() (kernel/rounding.h).
// - Lower: n has length at most 1, because its computed length errs by 2.5u, the quotient and the product with n by u
//   each, and the factor 1 - 8u takes all that away. A product n.v of three terms errs by 3u |n_x v_x| + ..., which is
//   at most 3u * sqrt(3) * M < 5.2uM. So n.p and h err by 5.2uM each, their difference by another u * 3.5M, and so
//   does the subtraction of the allowance: 17.4uM, for which 20uM are taken. The corners of a piece of level k are off
//   by 2k * uM.
#include "algorithms/meshes/distribution/mean_bounds.h"

#include "algorithms/kernel/point_triangle.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/triangle_block.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/meshes/distribution/point_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace hausbench::distribution {
namespace {

// Returns v times a bit less than 1 / |v|, so that the length is at most 1; the zero vector if v is too short.
Vec3 direction_of(const Vec3& v) {
    const double length = std::sqrt(squared_length(v));
    if (!(length > 0x1p-450)) return Vec3::Zero();
    return v * ((1 - 8 * unit_roundoff) / length);
}

double support(const Triangle& t, const Vec3& n) { return std::max({dot(n, t.a), dot(n, t.b), dot(n, t.c)}); }

Vec3 cross(const Vec3& x, const Vec3& y) {
    return {x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
}

CornerValues plane(const Piece& piece, const Triangle& t, const Vec3& n, double allowance) {
    const double h = support(t, n);
    return {dot(n, piece.corners[0]) - h - allowance, dot(n, piece.corners[1]) - h - allowance,
            dot(n, piece.corners[2]) - h - allowance};
}

bool below(const CornerValues& x, const CornerValues& y) { return x[0] < y[0] || x[1] < y[1] || x[2] < y[2]; }

double usable(const CornerValues& lower, const CornerValues& upper) {
    return std::min(lower[0], upper[0]) + std::min(lower[1], upper[1]) + std::min(lower[2], upper[2]);
}

// A point of a rule for the mean of a function over a triangle: its barycentric coordinates and its weight.
struct RulePoint {
    std::array<double, 3> at;
    double weight;
};

// Returns a rule of 25 points that is exact, but for rounding, for polynomials of degree 8: the product of two rules of
// Gauss and Legendre with five points, on a square that is mapped to the triangle.
const std::array<RulePoint, 25>& rule() {
    static const std::array<RulePoint, 25> points = [] {
        const double near = std::sqrt(5 - 2 * std::sqrt(10.0 / 7)) / 3,
                     far = std::sqrt(5 + 2 * std::sqrt(10.0 / 7)) / 3;
        const double heavy = (322 + 13 * std::sqrt(70.0)) / 1800, light = (322 - 13 * std::sqrt(70.0)) / 1800;
        const std::array<double, 5> at{0.5 * (1 - far), 0.5 * (1 - near), 0.5, 0.5 * (1 + near), 0.5 * (1 + far)};
        const std::array<double, 5> weight{light, heavy, 64.0 / 225, heavy, light};
        std::array<RulePoint, 25> made{};
        for (std::size_t i = 0; i < 5; ++i)
            for (std::size_t j = 0; j < 5; ++j)
                made[5 * i + j] = {{1 - at[i], at[i] * (1 - at[j]), at[i] * at[j]}, 2 * at[i] * weight[i] * weight[j]};
        return made;
    }();
    return points;
}

void lower_to(CornerValues& x, const CornerValues& y) {
    for (std::size_t k = 0; k < 3; ++k) x[k] = std::min(x[k], y[k]);
}

}  // namespace

// Rounding. Let u be the unit roundoff, x a side of a triangle from v, and h the part of x that is orthogonal to e.
// Subtractions err by u |x| and u |e|. The first projection leaves h off by 10u |x|, most of it along e; the second
// removes that part and leaves 5u |x|. So the unit vector along h errs by 5u |x| / |h| + 4u <= 9u |x| / |h|. The sum of
// two errs by at most 9u times `conditions`, and its direction by that over its length, and 4u: less than half of `tilt`.
// For needles |x| / |h| is large, and `tilt` with it, so beside() proves less but nothing wrong.
std::optional<Bisector> bisector_of(const Triangle& s, const Triangle& t) {
    const std::array<Vec3, 3> a{s.a, s.b, s.c}, b{t.a, t.b, t.c};
    std::array<std::size_t, 2> in_a{}, in_b{};
    std::size_t common = 0;
    for (std::size_t i = 0; i < 3 && common < 2; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            if (a[i] != b[j]) continue;
            in_a[common] = i;
            in_b[common] = j;
            ++common;
            break;
        }
    }
    if (common < 2 || in_b[0] == in_b[1]) return std::nullopt;
    const Vec3 v = a[in_a[0]], e = a[in_a[1]] - v;
    const double squared = squared_length(e);
    if (!(squared > 0)) return std::nullopt;
    double conditions = 0;
    const auto outward = [&](const Vec3& third) {
        const Vec3 side = third - v;
        Vec3 h = side - (dot(side, e) / squared) * e;
        h -= (dot(h, e) / squared) * e;
        const double length = std::sqrt(squared_length(h));
        conditions += std::sqrt(squared_length(side)) / length;
        return Vec3(h / -length);
    };
    const Vec3 m = outward(a[3 - in_a[0] - in_a[1]]) - outward(b[3 - in_b[0] - in_b[1]]);
    const double length = std::sqrt(squared_length(m));
    if (!(length > 0x1p-20 && conditions < 0x1p20)) return std::nullopt;
    return Bisector{v, m / length, 32 * unit_roundoff * conditions / length};
}

// Let r be the largest distance from the centre c to a point p of the piece. d(p) <= d(c) + r, so the triangle nearest to
// p is within d(c) + 2r of c.
//
// Rounding. Let u be the unit roundoff and M the magnitude. All lengths here are below 2 sqrt(3) M < 3.5M. d(c) is at most
// the root plus 4u * 3.5M + 8uM = 22uM (kernel/rounding.h, point to triangle). The farthest point is a corner; the way to
// it errs by 3.5u, which the factor 1 + 2^-40 covers, and a corner of level k is off by 2k * uM, which counts twice. The
// two sums below are at most 10.5M and err by 11uM each. Together this is (44 + 4k) uM, for which (64 + 4k) uM are taken.
double reach_of(const Piece& piece, double squared, double magnitude) {
    const Vec3 c = piece.centre();
    double radius = 0;
    for (const Vec3& corner : piece.corners) radius = std::max(radius, squared_length(corner - c));
    const double slack = WATCHED("distribution: corners that are off, in what is gathered",
                                 (64 + 4 * piece.level) * unit_roundoff * magnitude);
    return std::sqrt(squared) +
           WATCHED_ELSE("distribution: twice the radius of a piece is gathered", 2, 1.5) * std::sqrt(radius) *
               (1 + 0x1p-40) +
           slack;
}

namespace {

// Replaces lower values by others if these are better: if they are nowhere below the upper values, or higher in all.
void improve(CornerValues& low, const CornerValues& other, const CornerValues& upper) {
    if (usable(other, upper) > usable(low, upper)) low = other;
}

// Returns lower values for the distance to a triangle T of B that shares an edge with S. `by_face` are lower values for
// the plane of S. Let P be the plane that halves the angle between S and T. A reflection in P swaps the half-planes that
// contain S and T, so a point on the same side of P as S is at least as near to the half-plane of S. If a point is on
// the other side, at a distance f from P, the half-plane of T is nearer by at most 2f: moving the point onto P changes
// both distances by at most f.
CornerValues beside(const Piece& piece, const Triangle& s, const Triangle& t, const CornerValues& by_face,
                    double allowance) {
    const std::optional<Bisector> bisector = bisector_of(s, t);
    double loss = std::numeric_limits<double>::infinity();
    if (bisector) {
        double beyond = 0, far = 0;
        for (const Vec3& p : piece.corners) {
            beyond = std::max(beyond, bisector->side(p));
            far = std::max(far, squared_length(p - bisector->point));
        }
        loss = 2 *
               (WATCHED("distribution: what an edge loses beyond its plane of half the angle", beyond) + allowance +
                WATCHED("distribution: the error of the plane between two triangles", bisector->tilt * std::sqrt(far)));
    }
    return {by_face[0] - loss, by_face[1] - loss, by_face[2] - loss};
}

// Returns bounds on the distance if the piece and all triangles near it are points.
std::optional<AffineBounds> bounds_of_points(const Piece& piece, std::span<const NearbyTriangle> near,
                                             std::span<const std::uint16_t> among) {
    const auto is_point = [](const Vec3& a, const Vec3& b, const Vec3& c) { return a == b && a == c; };
    if (!is_point(piece.corners[0], piece.corners[1], piece.corners[2])) return std::nullopt;
    Bounds d{infinity, infinity};
    for (const std::uint16_t i : among) {
        const Triangle& t = near[i].corners;
        if (!is_point(t.a, t.b, t.c)) return std::nullopt;
        const Bounds to_point = point_distance(piece.corners[0], t.a);
        d = {std::min(d.lower, to_point.lower), std::min(d.upper, to_point.upper)};
    }
    AffineBounds bounds;
    bounds.lower.fill(d.lower);
    bounds.upper.fill(d.upper);
    bound_means(bounds);
    return bounds;
}

// Returns the first corner of the edge that a point of the triangle lies on; nothing if it lies on none.
std::optional<std::size_t> edge_of(const std::array<Vec3, 3>& corner, const Vec3& point) {
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 e = corner[(i + 1) % 3] - corner[i], f = point - corner[i], g = corner[(i + 2) % 3] - corner[i];
        const double away = squared_length(cross(e, f)), third = squared_length(cross(e, g));
        if (away <= 0x1p-60 * squared_length(e) * squared_length(e) && !(third == 0 && squared_length(e) == 0))
            return i;
    }
    return std::nullopt;
}

}  // namespace

void bound_means(AffineBounds& bounds) {
    const PositivePart below(bounds.lower), above(bounds.upper);
    constexpr double down = 1 - 32 * unit_roundoff, up = 1 + 32 * unit_roundoff;
    bounds.mean_lower = below.mean() * WATCHED_ELSE("distribution: rounding of the mean of a constant, below", down, 1);
    bounds.mean_upper = above.mean() * WATCHED_ELSE("distribution: rounding of the mean of a constant, above", up, 1);
    bounds.square_lower = below.mean_square() * down;
    bounds.square_upper = above.mean_square() * up;
}

// Lower: d falls by at most the way from the centre, which is convex, so at most affine between its values at the corners.
// Rounding, with u = 2^-53 and M of kernel/rounding.h. The centre is the point as computed, so its own rounding does not
// matter. The way to a corner errs by 3.5u (kernel/rounding.h, point to point), and the product with 1 + 8u by u, so
// `away` is not below it. A corner of level k is off by 2k * uM. Both lengths are below 2 sqrt(3) M < 3.5M, so each of
// the two subtractions errs by at most 3.5uM: 7uM, for which 8uM are taken.
AffineBounds MeanBounder::rough(const Piece& piece, const Triangle& near, double centre_at_least) {
    AffineBounds bounds;
    const Vec3 c = piece.centre();
    for (std::size_t k = 0; k < 3; ++k) {
        bounds.upper[k] =
            surface_distance_at_most(closest_point(piece.corners[k], near).squared_distance, magnitude_,
                                     WATCHED("distribution: rough bounds, corners that are off, above", piece.level));
        const double away = std::sqrt(squared_length(piece.corners[k] - c)) * (1 + 8 * unit_roundoff);
        bounds.lower[k] = centre_at_least -
                          WATCHED_ELSE("distribution: rough bounds, the way to a corner", away, 0.5 * away) -
                          (WATCHED("distribution: rough bounds, rounding", 8) +
                           WATCHED("distribution: rough bounds, corners that are off, below", 2 * piece.level)) *
                              unit_roundoff * magnitude_;
    }
    distances += 3;
    bound_means(bounds);
    return bounds;
}

AffineBounds MeanBounder::bounds(const Piece& piece, std::span<const NearbyTriangle> near,
                                 std::span<const std::uint16_t> among) {
    kept_.assign(1, among[0]);
    squares_.assign(1, {});  // a point is never cut
    if (const std::optional<AffineBounds> of_points = bounds_of_points(piece, near, among)) return *of_points;
    const double allowance = (WATCHED("distribution: rounding of a plane below the distance", 20) +
                              WATCHED("distribution: corners that are off, below", 2 * piece.level)) *
                             unit_roundoff * magnitude_;
    const Vec3 c = piece.centre();
    PointBlock points{};  // the corners and the centre
    for (int k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < 3; ++i) points.coordinate[k][i] = piece.corners[i][k];
        points.coordinate[k][3] = c[k];
    }
    const auto foot_of = [](const BlockFeet& feet, std::size_t i) {
        return Vec3(feet.point[0][i], feet.point[1][i], feet.point[2][i]);
    };
    AffineBounds bounds;
    std::uint16_t nearest = among[0];
    BlockFeet feet, others;
    closest_points_of_half(points, near[nearest].corners, feet);
    distances += 4;
    // A nearer triangle takes the place of the first one, and the search begins anew. The distance decreases each time,
    // and seldom more than once.
    for (bool again = true; again;) {
        again = false;
        const Triangle& s = near[nearest].corners;
        for (std::size_t k = 0; k < 3; ++k)
            bounds.upper[k] =
                surface_distance_at_most(feet.squared_distance[k], magnitude_,
                                         WATCHED("distribution: corners that are off, above", piece.level));
        const Vec3 straight = direction_of(c - foot_of(feet, 3));
        bounds.lower = plane(piece, s, straight, allowance);
        direction_ = straight;
        Vec3 normal = direction_of(cross(s.b - s.a, s.c - s.a));
        if (dot(normal, c - s.a) < 0) normal = -normal;
        const CornerValues by_face = plane(piece, s, normal, allowance);
        if (usable(by_face, bounds.upper) > usable(bounds.lower, bounds.upper)) {
            bounds.lower = by_face;
            direction_ = normal;
        }
        kept_.assign(1, nearest);
        needed_.assign(1, 1);
        squares_.assign(1, {feet.squared_distance[0], feet.squared_distance[1], feet.squared_distance[2]});
        for (const std::uint16_t i : among) {
            if (i == nearest) continue;
            const Triangle& other = near[i].corners;
            CornerValues low = plane(piece, other, direction_, allowance);
            if (!below(low, bounds.upper)) continue;
            closest_points_of_half(points, other, others);
            distances += 4;
            if (others.squared_distance[3] < feet.squared_distance[3]) {
                nearest = i;
                feet = others;
                again = true;
                break;
            }
            improve(low, plane(piece, other, direction_of(c - foot_of(others, 3)), allowance), bounds.upper);
            improve(low, beside(piece, s, other, by_face, allowance), bounds.upper);
            std::size_t worst = 0;
            for (std::size_t k = 1; k < 3; ++k)
                if (bounds.upper[k] - low[k] > bounds.upper[worst] - low[worst]) worst = k;
            improve(low, plane(piece, other, direction_of(piece.corners[worst] - foot_of(others, worst)), allowance),
                    bounds.upper);
            if (!below(low, bounds.upper)) continue;
            kept_.push_back(i);
            squares_.push_back({others.squared_distance[0], others.squared_distance[1], others.squared_distance[2]});
            const double slack = 5 * allowance;
            const CornerValues nearly{bounds.upper[0] - slack, bounds.upper[1] - slack, bounds.upper[2] - slack};
            needed_.push_back(below(low, nearly) ? 1 : 0);
            if (WATCHED("distribution: the plane of every triangle that may be nearest", true))
                lower_to(bounds.lower, low);
        }
    }
    foot_ = foot_of(feet, 3);
    lower_to(bounds.lower, bounds.upper);
    bound_means(bounds);
    curved(piece, near, bounds);
    return bounds;
}

// If the same corner or edge F of B is nearest for all points of T, then d^2 is a quadratic polynomial q on T. The mean
// of q has a closed form, and a quadrature rule of 25 points computes the mean of its root d.
//
// Let y(a) be the vector from the nearest point of F, or of the line through the edge F, to a. It is affine on T, and
// q = |y|^2.
// - Upper: d <= q^(1/2) for a corner. Beyond the ends of an edge by up to o, d^2 <= q + o^2.
// - Lower, for a triangle S with the corner v = F and the edges e1, e2 from there: a point of S is v + s e1 + t e2 with
//   s, t >= 0 and s + t <= 1. Its squared distance from a is at least q - 2 max(y.e1, y.e2, 0).
// - Lower, for a triangle S with the edge F: let h be the vector from the line to its third corner, orthogonal to the
//   line. A point of S is on the line plus s h, with 0 <= s <= 1. Its squared distance is at least q - 2 max(y.h, 0).
// So d^2 >= q - loss, with a loss that is positive only by rounding, or because T reaches beyond the region of F. All
// triangles of C must have F, or be nowhere nearer than the triangle nearest to the centre.
//
// The rule is exact for polynomials of degree 8, so for the first five terms of the series of q^(1/2) around the middle
// q0 of the range of q. With r = (greatest q - least q) / (greatest q + least q), the other terms are at most
// q0^(1/2) * 7/256 * r^5 / (1 - r), because the coefficients decrease. The rule and the integral differ by at most
// twice that.
//
// Rounding: y errs by less than 30uM, products y.e by less than 60uM |e|, the rule by 200uM in all, and the mean of q
// by 200uM times the largest d. A corner of level k is off by 2k * uM.
void MeanBounder::curved(const Piece& piece, std::span<const NearbyTriangle> near, AffineBounds& bounds) {
    const Triangle& s = near[kept_[0]].corners;
    const std::array<Vec3, 3> corner{s.a, s.b, s.c};
    const double unit = unit_roundoff * magnitude_;
    std::optional<std::size_t> vertex;
    for (std::size_t i = 0; i < 3; ++i)
        if (corner[i] == foot_) vertex = i;
    // The foot may lie on an edge and yet the face be the nearest feature: then the planes are as good.
    const auto edge = vertex ? std::nullopt : edge_of(corner, foot_);
    if (!vertex && !edge) return;
    const std::size_t from = edge.value_or(0);
    const Vec3 v = vertex ? corner[*vertex] : corner[from], end = vertex ? v : corner[(from + 1) % 3], e = end - v;
    const double squared_edge = squared_length(e);
    std::array<Vec3, 3> y;
    double beyond = 0, greatest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        y[k] = piece.corners[k] - v;
        if (!vertex) {
            const double along = dot(y[k], e) / squared_edge, length = std::sqrt(squared_edge);
            beyond = std::max({beyond, -along * length, (along - 1) * length});
            y[k] -= along * e;
            y[k] -= (dot(y[k], e) / squared_edge) * e;
        }
        greatest = std::max(greatest, squared_length(y[k]));
    }
    if (beyond > 0) beyond += (64 + 2 * piece.level) * unit;
    double loss = 0;
    const auto part_of = [&](const Vec3& side) {
        const double length = std::sqrt(squared_length(side));
        for (const Vec3& x : y) loss = std::max(loss, 2 * (dot(x, side) + (64 + 2 * piece.level) * unit * length));
    };
    const auto has = [](const Triangle& t, const Vec3& p) { return t.a == p || t.b == p || t.c == p; };
    double slack = 0;
    for (std::size_t i = 0; i < kept_.size(); ++i) {
        const Triangle& t = near[kept_[i]].corners;
        if (!has(t, v) || !has(t, end)) {
            if (WATCHED("distribution: triangles nearer than the edge", needed_[i])) return;
            slack = WATCHED("distribution: triangles that are nearer by rounding", 5 * (20 + 2 * piece.level) * unit);
            continue;
        }
        for (const Vec3& other : {t.a, t.b, t.c}) {
            if (other == v || other == end) continue;
            Vec3 side = other - v;
            if (!vertex) {
                side -= (dot(side, e) / squared_edge) * e;
                side -= (dot(side, e) / squared_edge) * e;
            }
            part_of(side);
        }
    }
    const double least = bounds.least(), most = std::sqrt(greatest);
    const double mean_of_squares =
        (dot(y[0], y[0]) + dot(y[1], y[1]) + dot(y[2], y[2]) + dot(y[0], y[1]) + dot(y[1], y[2]) + dot(y[2], y[0])) / 6;
    const double off = (WATCHED("distribution: rounding of a polynomial", 200) +
                        WATCHED("distribution: corners off their places", 4 * piece.level)) *
                       unit;
    const double off_squared = 2 * off * (most + off);
    bounds.square_lower =
        std::max(bounds.square_lower, mean_of_squares - WATCHED("distribution: squares over the face", loss) -
                                          off_squared - 2 * slack * most);
    bounds.square_upper =
        std::min(bounds.square_upper,
                 mean_of_squares + WATCHED("distribution: squares past an end", beyond * beyond) + off_squared);
    const double low = least * least, range = (greatest - low) / (greatest + low);
    if (!(least > 0 && range < 0.5 && loss <= low)) return;
    double mean = 0;
    for (const RulePoint& point : rule())
        mean += point.weight * std::sqrt(squared_length(point.at[0] * y[0] + point.at[1] * y[1] + point.at[2] * y[2]));
    const double middle = std::sqrt(0.5 * (greatest + low));
    const double squared_range = range * range;
    const double truncated =
        WATCHED("distribution: the rule is not exact",
                2 * middle * (7.0 / 256) * squared_range * squared_range * range / (1 - range) * (1 + 0x1p-40));
    bounds.mean_lower = std::max(bounds.mean_lower, mean - truncated - off - slack -
                                                        WATCHED("distribution: distances over the face", loss / least));
    bounds.mean_upper =
        std::min(bounds.mean_upper,
                 mean + truncated + off + WATCHED("distribution: distances past an end", beyond * beyond / least));
}

}  // namespace hausbench::distribution
