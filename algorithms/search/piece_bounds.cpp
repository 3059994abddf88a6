#include "algorithms/search/piece_bounds.h"

#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <cmath>

namespace hausbench {
namespace {

double largest_squared(const PieceCorners& v) { return std::max({v[0].squared, v[1].squared, v[2].squared}); }

// Returns the squared length of the edge opposite to each corner.
std::array<double, 3> squared_edges(const std::array<Vec3, 3>& v) {
    return {squared_length(v[2] - v[1]), squared_length(v[0] - v[2]), squared_length(v[1] - v[0])};
}

std::array<Vec3, 3> points_of(const PieceCorners& v) { return {v[0].point, v[1].point, v[2].point}; }

// Returns the point of the edge ab at which a linear function with these values at a and b is zero. Exactly one value
// must be positive; then t is in [0, 1] even after rounding.
Vec3 zero_on_edge(const Vec3& a, const Vec3& b, double at_a, double at_b) {
    const double t = at_a / (at_a - at_b);
    return (1 - t) * a + t * b;
}

// Returns the unit vector orthogonal to the edge ab that points to the side of `apex`, or NaN if `apex` lies on the
// line ab.
Vec3 across(const Vec3& a, const Vec3& b, const Vec3& apex) {
    const Vec3 edge = b - a, to = apex - a;
    const Vec3 height = to - (dot(to, edge) / squared_length(edge)) * edge;
    return height / std::sqrt(squared_length(height));
}

// A plane through `origin`. of(point) is 0 on the plane, and positive on the side to which the normal points.
struct Plane {
    Vec3 origin, normal;
    double of(const Vec3& point) const { return dot(point - origin, normal); }
};

// Returns the plane that halves the angle between two triangles of B with a common edge; Plane::of() is positive on the
// side of `one`. Returns nothing if they do not share exactly two corners. Compares corners by their coordinates,
// because neighbours may have separate copies of their vertices.
std::optional<Plane> bisector(const Triangle& one, const Triangle& two) {
    const std::array<Vec3, 3> p{one.a, one.b, one.c}, q{two.a, two.b, two.c};
    std::array<int, 3> partner{-1, -1, -1};
    int shared = 0, alone_p = 0, in_q = 0;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3 && partner[i] < 0; ++j) {
            if (p[i] == q[j]) partner[i] = j;
        }
        if (partner[i] < 0) {
            alone_p = i;
        } else {
            ++shared;
            in_q += partner[i];
        }
    }
    if (shared != 2 || in_q < 1 || in_q > 3) return std::nullopt;
    const Vec3 &a = p[(alone_p + 1) % 3], &b = p[(alone_p + 2) % 3];
    return Plane{a, across(a, b, p[alone_p]) - across(a, b, q[3 - in_q])};
}

// Returns the largest squared distance from a point of triangle v to the nearer of p and q. The plane midway between p
// and q cuts the triangle in two. On each part the distance is convex, so the maximum is at a corner of the triangle or
// where the plane cuts an edge. Sets `nearer`, for each corner, to the squared distance to p minus the squared distance
// to q.
double squared_to_two_points(const std::array<Vec3, 3>& v, const Vec3& p, const Vec3& q,
                             std::array<double, 3>& nearer) {
    double most = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double to_p = squared_length(v[i] - p), to_q = squared_length(v[i] - q);
        nearer[i] = to_p - to_q;
        most = std::max(most, std::min(to_p, to_q));
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        // The plane does not cut this edge. If p = q, it cuts no edge, so zero_on_edge() never divides 0 by 0.
        if ((nearer[i] > 0) == (nearer[j] > 0)) continue;
        const Vec3 cut = zero_on_edge(v[i], v[j], nearer[i], nearer[j]);
        if (WATCHED("pieces: the cuts count in u4", true))
            most = std::max({most, squared_length(cut - p), squared_length(cut - q)});
    }
    return most;
}

}  // namespace

// Let x >= y >= z be the edges and X the angle opposite to x, so cos X = (y^2 + z^2 - x^2) / (2yz). The triangle is
// acute if cos X > 0. Its circumradius is then x / (2 sin X), which is well conditioned, because X, the largest angle
// of an acute triangle, is in [60, 90] degrees.
//
// Rounding, with u = 2^-53. Write s_x for the computed x^2, and s_y, s_z likewise. s_x is within 5.01u x^2 of x^2. The
// computed (s_y + s_z) - s_x errs by
// - 5.01u (x^2 + y^2 + z^2) from the three squares,
// - 2.1u x^2 from the sum,
// - 1.1u x^2 from the difference,
// which is less than 19u x^2 in total, because y, z <= x. The code adds 24u s_x, so `twice` is at least the exact
// y^2 + z^2 - x^2. Then cos X is at most (1 + 9u) * `cosine`, and its square at most (1 + 19u) times the computed
// square. The square is capped at 1/4, which is right because X is at least 60 degrees. So 1 - square, which is at
// least 3/4, has a relative error of (19/4 + 2)u / (3/4) = 9u, and its root one of 5u. With 3.5u for sqrt(s_x) and u
// for the division this is less than 10u in total.
// If rounding took another edge for the longest, that edge is shorter than x by at most the fraction 5.1u, and sin X is
// smaller by as much; then 3.5u, 2u and 5.1u add up to less than 11u. If the triangle is not acute, `twice` is not
// used, and half of the longest edge errs by 3.5u and 5.1u. The factor 1 + 16u covers each of these cases, and the
// rounding of the product with it.
//
// Underflow: if x < 2^-459, the result errs by at most 2^-459. That is 1/64 of the uM that surface_sum_at_most() has to
// spare, because M, the largest |coordinate|, is at least 2^-400 (kernel/rounding.h). If x >= 2^-459, squares that
// underflow are off by 2^-155 s_x, which is negligible. If z is so short that its own square is subnormal, the cap
// applies: `twice` is at least 5u s_x, so `cosine` is infinite or at least
// 2.4u sqrt(s_x) / sqrt(s_z) >= 2.4u * 2^-459 / 2^-511 > 1.
double covering_radius_at_most(const std::array<Vec3, 3>& corners) {
    std::array<double, 3> edges = squared_edges(corners);
    std::sort(edges.begin(), edges.end());
    const auto [z, y, x] = edges;
    const double twice =
        ((y + z) - x) + WATCHED("pieces: the cosine of a covering radius is widened", 24 * unit_roundoff * x);
    if (!(twice > 0))
        return 0.5 * std::sqrt(x) * (1 + WATCHED("pieces: half of the longest edge is widened", 16 * unit_roundoff));
    const double cosine = twice / (2 * (std::sqrt(y) * std::sqrt(z)));
    const double square =
        std::min(cosine * cosine, WATCHED_ELSE("pieces: a largest angle has 60 degrees or more", 0.25, 0.2));
    return std::sqrt(x) / (2 * std::sqrt(1 - square)) *
           (1 + WATCHED("pieces: a circumradius is widened", 16 * unit_roundoff));
}

double PieceBounds::same_triangle(const PieceCorners& v, int level) {
    const bool same = v[0].triangle == v[1].triangle && v[0].triangle == v[2].triangle;
    by_one(v[0].triangle);
    return same ? WATCHED_ELSE("pieces: the exact case is widened", at_most(largest_squared(v), level),
                               std::sqrt(largest_squared(v)))
                : infinity;
}

// `slack` allows for the rounding of the two distances that are compared. It cannot make the result wrong: the distance
// to any triangle of B is an upper bound on the distance to B.
double PieceBounds::tied_triangle(const PieceCorners& v, int level) {
    const double slack = 8 * unit_roundoff * magnitude_;
    ++counters_.bound_tests;
    for (std::size_t i = 0; i < 3; ++i) {
        if (i > 0 && v[i].triangle == v[i - 1].triangle) continue;
        const Triangle near = target_.triangle(v[i].triangle);
        double most = v[i].squared;
        bool all = true;
        for (std::size_t j = 0; j < 3 && all; ++j) {
            if (v[j].triangle == v[i].triangle) continue;
            ++counters_.point_triangle_distances;
            const double squared = target_.squared_distance(v[j].point, near);
            all = WATCHED_ELSE("pieces: only a triangle as near as any is a tie",
                               std::sqrt(squared) <= std::sqrt(v[j].squared) + slack, true);
            most = std::max(most, WATCHED("pieces: a tie counts all corners", squared));
        }
        by_one(v[i].triangle);
        if (all) {
            return WATCHED_ELSE("pieces: a tie is widened", at_most(std::max(most, largest_squared(v)), level),
                                std::sqrt(std::max(most, largest_squared(v))));
        }
    }
    return infinity;
}

double PieceBounds::u1(const PieceCorners& v, int level) {
    ++counters_.bound_tests;
    const auto edges = squared_edges(points_of(v));
    double least = infinity;
    for (std::size_t i = 0; i < 3; ++i) {
        const double edge =
            std::max(edges[(i + 1) % 3], WATCHED("pieces: u1 takes the longest edge at a corner", edges[(i + 2) % 3]));
        const double sum = std::sqrt(edge) + std::sqrt(v[i].squared);
        if (sum < least) {
            least = sum;
            by_one(v[WATCHED("proofs: the triangle of u1", i)].triangle);
        }
    }
    return WATCHED_ELSE("pieces: u1 is widened", surface_sum_at_most(least, magnitude_, level), least);
}

double PieceBounds::u2(const PieceCorners& v, int level) {
    ++counters_.bound_tests;
    argument_.kind = PieceArgument::Kind::nearest_corner;
    const double radius = covering_radius_at_most(points_of(v));
    return WATCHED_ELSE(
        "pieces: u2 is widened",
        surface_sum_at_most(radius + std::sqrt(WATCHED_ELSE("pieces: u2 takes the largest distance of a corner",
                                                            largest_squared(v), v[0].squared)),
                            magnitude_, level),
        radius + std::sqrt(largest_squared(v)));
}

BlockFeet PieceBounds::distances(const std::array<Vec3, 7>& points, std::size_t count, Index triangle) {
    PointBlock block;
    for (std::size_t lane = 0; lane < block_width; ++lane) {
        const Vec3& point = points[std::min(lane, count - 1)];
        for (int k = 0; k < 3; ++k) block.coordinate[k][lane] = point[k];
    }
    BlockFeet feet;
    target_.squared_distances(block, count, target_.triangle(triangle), feet);
    counters_.point_triangle_distances += count;
    return feet;
}

// Cuts the piece into two cells, one with corner `alone`, the other with the other two corners, which have the same
// nearest triangle of B. Returns the largest squared distance from a corner of a cell to the nearest triangle of that
// cell, or infinity if the two triangles have no common edge.
double PieceBounds::in_two(const PieceCorners& v, std::size_t alone) {
    const MeasuredPoint &a = v[alone], &b = v[(alone + 1) % 3], &c = v[(alone + 2) % 3];
    const auto side = bisector(target_.triangle(a.triangle), target_.triangle(b.triangle));
    if (!side) return infinity;
    const double s = side->of(a.point), s2 = side->of(b.point), s3 = side->of(c.point);
    argument_.kind = PieceArgument::Kind::corner_cut_off;
    argument_.alone = alone;
    argument_.ends = {1, -1, -1};
    // Cuts the edges at corner `alone` where they meet the plane that halves the angle between the triangles, if both
    // do; otherwise at their midpoints.
    std::array<Vec3, 7> cuts{0.5 * (a.point + b.point), 0.5 * (a.point + c.point)};
    if (s > 0 && s2 <= 0 && s3 <= 0 && s < infinity) {
        cuts = {zero_on_edge(a.point, b.point, s, s2), zero_on_edge(a.point, c.point, s, s3)};
        argument_.ends = {s, s2, s3};
    }
    const BlockFeet to_a = distances(cuts, 2, a.triangle), to_b = distances(cuts, 2, b.triangle);
    return std::max({largest_squared(v),
                     WATCHED("pieces: the first cut counts against the first triangle", to_a.squared_distance[0]),
                     to_a.squared_distance[1], to_b.squared_distance[0],
                     WATCHED("pieces: the second cut counts against the second triangle", to_b.squared_distance[1])});
}

// Cuts the piece into three cells, one for each corner: the quadrilateral of the corner, the midpoints of its two edges
// and the barycentre. Returns the largest squared distance from a cell to the triangle of B nearest to its corner. Also
// bounds the whole piece by the best of these three triangles: sets `near` to this triangle and `whole` to the squared
// bound.
double PieceBounds::in_three(const PieceCorners& v, double& whole, Index& near) {
    std::array<Vec3, 7> points{v[0].point, v[1].point, v[2].point};
    for (std::size_t k = 0; k < 3; ++k) points[3 + k] = 0.5 * (v[(k + 1) % 3].point + v[(k + 2) % 3].point);
    points[6] = barycentre(v);
    double most = 0;
    whole = infinity;
    BlockFeet feet;
    for (std::size_t i = 0; i < 3; ++i) {
        if (i == 0 || v[i].triangle != v[i - 1].triangle) feet = distances(points, 7, v[i].triangle);
        const double* squared = feet.squared_distance;
        const double of_whole = std::max({squared[0], squared[1], squared[2]});
        if (of_whole < whole) {
            whole = of_whole;
            near = v[i].triangle;
        }
        most = std::max({most, squared[i], squared[3 + (i + 1) % 3],
                         WATCHED("pieces: the midpoints count in u3", squared[3 + (i + 2) % 3]),
                         WATCHED("pieces: the barycentre counts in u3", squared[6])});
    }
    return most;
}

// Rounding may move the corners of cells off the piece. level_of_inner_point bounds this error, and is added to
// `level`, the error of the piece's own corners (kernel/rounding.h).
double PieceBounds::u3(const PieceCorners& v, int level) {
    ++counters_.bound_tests;
    for (std::size_t alone = 0; alone < 3; ++alone) {
        const Index others = v[(alone + 1) % 3].triangle;
        if (others != v[(alone + 2) % 3].triangle) continue;
        if (others == v[alone].triangle) return same_triangle(v, level);
        const double two = in_two(v, alone);
        if (two < infinity)
            return at_most(two, level + WATCHED("pieces: a piece in two parts is widened by what its cuts are off",
                                                level_of_inner_point));
    }
    double whole = infinity;
    Index near = -1;
    const double three = at_most(
        in_three(v, whole, near),
        level + WATCHED("pieces: a piece in three parts is widened by what its cuts are off", level_of_inner_point));
    const double of_whole = at_most(whole, level);
    if (of_whole < three)
        by_one(near);
    else
        argument_.kind = PieceArgument::Kind::three;
    return std::min(three, of_whole);
}

// A foot is the point of B closest to a corner. As computed, it is within 7uM of B, where u = 2^-53 and M is the
// largest |coordinate|. Distances to feet err as much as distances to B, so they are widened in the same way.
double PieceBounds::u4(const PieceCorners& v, int level) {
    ++counters_.bound_tests;
    const auto points = points_of(v);
    const auto edges = squared_edges(points);
    // Tries the ends of each of the two longer edges, which meet at the corner opposite to the shortest edge.
    const auto shortest =
        static_cast<std::size_t>(std::distance(edges.begin(), std::min_element(edges.begin(), edges.end())));
    std::array<Vec3, 3> feet;
    counters_.point_triangle_distances += 3;
    for (std::size_t i = 0; i < 3; ++i) feet[i] = closest_point(points[i], target_.triangle(v[i].triangle)).point;
    argument_.kind = PieceArgument::Kind::nearest_foot;
    double squared = infinity;
    for (const std::size_t other : {(shortest + 1) % 3, (shortest + 2) % 3}) {
        std::array<double, 3> nearer;
        const double of_pair = squared_to_two_points(points, feet[shortest], feet[other], nearer);
        if (!(of_pair < squared)) continue;
        squared = of_pair;
        argument_.nearer = nearer;
        argument_.feet = {shortest, other};
    }
    return at_most(squared, level + WATCHED("pieces: u4 is widened by what its cuts are off", level_of_inner_point));
}

double PieceBounds::squared_to_triangle(const PieceCorners& v, Index triangle) {
    const BlockFeet feet = distances({v[0].point, v[1].point, v[2].point}, 3, triangle);
    return std::max({feet.squared_distance[0], feet.squared_distance[1],
                     WATCHED("pieces: each corner counts in a distance to one triangle", feet.squared_distance[2])});
}

double PieceBounds::nearest_triangles(const PieceCorners& v, int level, Index fourth) {
    ++counters_.bound_tests;
    if (fourth >= 0) {
        by_one(fourth);
        return at_most(squared_to_triangle(v, fourth), level);
    }
    double least = infinity;
    for (const MeasuredPoint& corner : v) {
        const double most = squared_to_triangle(v, corner.triangle);
        if (most < least) {
            least = most;
            by_one(corner.triangle);
        }
    }
    return at_most(least, level);
}

}  // namespace hausbench
