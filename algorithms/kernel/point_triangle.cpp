#include "point_triangle.h"

#include "rounding.h"

#include <cmath>

namespace hausbench {
namespace {

// Triangles with sin^2 of the angle at `a` above this are settled without looking at their segments; a choice of speed,
// not of accuracy: two refinements bring the foot down to rounding from there.
constexpr double well_shaped = 0x1p-20;

Vec3 cross(const Vec3& x, const Vec3& y) {
    return {x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
}

Vec3 closest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 edge = b - a;
    const double along = dot(edge, p - a), length = squared_length(edge);
    if (!(along > 0)) return a;
    if (!(along < length)) return b;
    const double t = along / length;
    if (t > 0.5) return b - std::min(std::max(dot(edge, b - p) / length, 0.0), 1.0) * edge;
    return a + t * edge;
}

struct Best {
    const Vec3& p;
    const Box& box;
    TrianglePoint best{std::numeric_limits<double>::infinity(), Vec3::Zero()};

    void offer(const Vec3& q) {
        const Vec3 clamped = q.cwiseMax(box.low).cwiseMin(box.high);
        const double squared = squared_length(p - clamped);
        if (squared < best.squared_distance) best = {squared, clamped};
    }
};

}  // namespace

TrianglePoint closest_point(const Vec3& p, const Triangle& triangle) {
    const Box box = box_of(triangle);
    const Vec3 ab = triangle.b - triangle.a, ac = triangle.c - triangle.a, ap = p - triangle.a;
    const Vec3 normal = cross(ab, ac);
    const double area = squared_length(normal);
    Best result{p, box};

    double s = 0, t = 0;
    const bool flat = !(area > 0);
    if (!flat) {
        s = dot(normal, cross(ap, ac)) / area;
        t = dot(normal, cross(ab, ap)) / area;
    }
    const bool good = area > well_shaped * (squared_length(ab) * squared_length(ac));
    if (!flat && s >= 0 && t >= 0 && s + t <= 1) {
        for (int step = 0; step < 2; ++step) {
            const Vec3 r = p - (triangle.a + (s * ab + t * ac));
            s = std::min(std::max(s + dot(normal, cross(r, ac)) / area, 0.0), 1.0);
            t = std::min(std::max(t + dot(normal, cross(ab, r)) / area, 0.0), 1 - s);
        }
        result.offer(triangle.a + (s * ab + t * ac));
        if (good) return result.best;
    }
    // The closest point of one outside is on an edge that it is beyond.
    if (!good || t <= 0) result.offer(closest_on_segment(p, triangle.a, triangle.b));
    if (!good || s <= 0) result.offer(closest_on_segment(p, triangle.a, triangle.c));
    if (!good || s + t >= 1) result.offer(closest_on_segment(p, triangle.b, triangle.c));
    return result.best;
}

double distance_certainly_at_least(const Vec3& p, const Triangle& triangle, const Vec3& q) {
    const Vec3 w[3] = {p - triangle.a, p - triangle.b, p - triangle.c};
    double size = 0;
    for (const Vec3& x : w) size = std::max(size, std::abs(x[0]) + std::abs(x[1]) + std::abs(x[2]));
    double best = 0;
    const auto try_direction = [&](const Vec3& n) {
        const double length = std::sqrt(squared_length(n));
        if (!(length > 0x1p-450) || std::isinf(length)) return;
        const double least = std::min({dot(n, w[0]), dot(n, w[1]), dot(n, w[2])});
        best = std::max(best, least / length * (1 - 5 * unit_roundoff) - (6 * unit_roundoff * size + 0x1p-600));
    };
    // Twice: the second time removes what rounding left the first time.
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
    // The normal, from the two shorter edges, straightened along the longest, where a slant costs most.
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
