#include "algorithms/kernel/point_triangle.h"

#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"

#include <cmath>

namespace hausbench {
namespace {

Vec3 cross(const Vec3& x, const Vec3& y) {
    return {x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
}

// Returns the point of an edge that is closest to a query point p. `along` is (to - from).(p - from), `length` the
// squared length of the edge, and `inverse` is 1 / length. Triangles without area may give NaN here and in
// closest_point(); the code relies on comparisons with NaN being false. point_triangle-inl.h must perform the same
// operations in the same order.
Vec3 closest_on_edge(const Vec3& from, const Vec3& to, double along, double length, double inverse) {
    double t = along < length ? std::min(along * inverse, 1.0) : 1.0;
    t = along > 0 ? t : 0.0;
    return (1 - t) * from + t * to;
}

}  // namespace

TrianglePoint closest_point(const Vec3& p, const Triangle& triangle) {
    const auto [a, b, c] = longest_edge_first(triangle);
    const Vec3 e = b - a, f = c - a, g = c - b, ap = p - a, bp = p - b;
    const double ee = squared_length(e), ff = squared_length(f), gg = squared_length(g);
    const double along_e = dot(e, ap), along_f = dot(f, ap), along_g = dot(g, bp);
    const double inverse_e = 1 / ee, inverse_f = 1 / ff, inverse_g = 1 / gg;

    Vec3 q = closest_on_edge(a, b, along_e, ee, inverse_e);
    double squared = squared_length(p - q);
    const auto offer = [&](const Vec3& other) {
        const double other_squared = squared_length(p - other);
        if (!(other_squared < squared)) return;
        q = other;
        squared = other_squared;
    };
    offer(closest_on_edge(a, c, along_f, ff, inverse_f));
    offer(closest_on_edge(b, c, along_g, gg, inverse_g));

    const double x_c = dot(f, e) * inverse_e;
    Vec3 h = f - x_c * e;
    h = h - (dot(h, e) * inverse_e) * e;
    const double y = dot(h, ap) / squared_length(h);
    const double x = along_e * inverse_e - y * x_c;
    if (x >= 0 && y >= 0 && WATCHED_ELSE("closest_point: only feet inside the triangle", x + y <= 1, true))
        offer((std::max((1 - x) - y, 0.0) * a + x * b) + y * c);

    const Box box = box_of(triangle);
    q = q.cwiseMax(box.low).cwiseMin(box.high) + Vec3::Zero();  // -0 becomes 0
    return {squared_length(p - q), q};
}

double distance_certainly_at_least(const Vec3& p, const Triangle& triangle, const Vec3& q) {
    const Vec3 w[3] = {p - triangle.a, p - triangle.b, p - triangle.c};
    double size = 0;
    for (const Vec3& x : w) size = std::max(size, std::abs(x[0]) + std::abs(x[1]) + std::abs(x[2]));
    double best = 0;
    const auto try_direction = [&](const Vec3& n) {
        const double length = std::sqrt(squared_length(n));
        if (!(length > WATCHED("distance_certainly_at_least: normals whose length underflows", 0x1p-450)) ||
            std::isinf(length))
            return;
        const double least = std::min({dot(n, w[0]), dot(n, w[1]), dot(n, w[2])});
        best = std::max(
            best, least / length - (WATCHED_ELSE("distance_certainly_at_least: a bound that is too large, replayed",
                                                 WATCHED("distance_certainly_at_least: the rounding error",
                                                         9 * unit_roundoff * size),
                                                 -0.01 * size) +
                                    WATCHED("distance_certainly_at_least: underflow", 0x1p-600)));
    };
    // Makes n orthogonal to an edge by subtracting its component along the edge. The second step removes the component
    // that rounding leaves in the first.
    const auto without = [](Vec3 n, const Vec3& edge) {
        const double length = squared_length(edge);
        if (!(length > 0)) return n;
        for (int step = 0; step < 2; ++step) n -= dot(n, edge) / length * edge;
        return n;
    };

    const Vec3 direct = p - q;
    const Vec3 edges[3] = {triangle.b - triangle.a, triangle.c - triangle.b, triangle.a - triangle.c};
    try_direction(direct);
    for (const Vec3& edge : edges) try_direction(without(direct, edge));
    // Compute the normal from the two shorter edges, then make it orthogonal to the longest edge, because a tilt along
    // the longest edge would weaken the bound most.
    int longest = 0;
    for (int k = 1; k < 3; ++k) {
        if (squared_length(edges[k]) > squared_length(edges[longest])) longest = k;
    }
    Vec3 normal = without(cross(edges[(longest + 1) % 3], edges[(longest + 2) % 3]), edges[longest]);
    if (dot(normal, direct) < 0) normal = -normal;
    try_direction(normal);
    return next_down(best) > 0 ? next_down(best) : 0;
}

}  // namespace hausbench
