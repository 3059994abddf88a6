#include "algorithms/meshes/tang/enclosed_move.h"

#include "algorithms/kernel/watched.h"
#include "algorithms/meshes/tang/adjacency.h"
#include "algorithms/meshes/tang/near_walk.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace hausbench::tang {

namespace {

// The most triangles of B to test against a moving piece. If more are near, no bound is computed, because testing them
// all would cost too much.
constexpr std::size_t most_near_move = 256;

using Corners = std::array<Vec3, 3>;

// Returns whether the convex hulls of two sets of points are more than `margin` apart along an axis. The axis itself
// may be inaccurate: a wrong axis may fail to separate the sets but never separates sets that touch.
bool apart_along(Vec3 axis, std::span<const Vec3> first, std::span<const Vec3> second, double margin) {
    const double size = axis.cwiseAbs().maxCoeff();
    if (!(size > 0 && size < infinity)) return false;
    axis /= size;
    double low[2] = {infinity, infinity}, high[2] = {-infinity, -infinity};
    for (const Vec3& p : first) {
        low[0] = std::min(low[0], dot(axis, p));
        high[0] = std::max(high[0], dot(axis, p));
    }
    for (const Vec3& p : second) {
        low[1] = std::min(low[1], dot(axis, p));
        high[1] = std::max(high[1], dot(axis, p));
    }
    return low[0] - high[1] > margin || low[1] - high[0] > margin;
}

// Tries to separate two triangles, or a segment and a triangle, by more than `margin` along an axis: first the normals
// of the triangles, then the cross products of their edges. Returns whether one of the axes separates them.
bool apart(std::span<const Vec3> first, const Corners& second, double margin) {
    const auto edge = [](std::span<const Vec3> p, std::size_t k) { return Vec3(p[(k + 1) % p.size()] - p[k]); };
    if (first.size() == 3 && apart_along(edge(first, 0).cross(edge(first, 1)), first, second, margin)) return true;
    if (apart_along(edge(second, 0).cross(edge(second, 1)), first, second, margin)) return true;
    for (std::size_t i = 0; i < first.size(); ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            if (apart_along(edge(first, i).cross(edge(second, j)), first, second, margin)) return true;
        }
    }
    // If both shapes lie in one plane, all axes above are normal to it. Try the directions in this plane that are
    // perpendicular to an edge.
    const Vec3 normal = edge(second, 0).cross(edge(second, 1));
    for (std::size_t i = 0; i < first.size(); ++i) {
        if (apart_along(normal.cross(edge(first, i)), first, second, margin)) return true;
    }
    for (std::size_t j = 0; j < 3; ++j) {
        if (apart_along(normal.cross(edge(second, j)), first, second, margin)) return true;
    }
    return false;
}

// Returns whether a segment crosses the interior of the triangle `t`. Returns nullopt if rounding errors leave this
// undecided. Neither end of the segment may lie on the triangle.
std::optional<bool> crosses(const std::array<Vec3, 2>& segment, const Corners& t, double margin) {
    if (apart(segment, t, margin)) return false;
    const Vec3 &p = segment[0], &q = segment[1];
    const int at_p = orientation(t[0], t[1], t[2], p), at_q = orientation(t[0], t[1], t[2], q);
    if (at_p == 0 || at_q == 0) return std::nullopt;
    if (at_p == at_q) return false;
    const int ab = orientation(p, q, t[0], t[1]), bc = orientation(p, q, t[1], t[2]),
              ca = orientation(p, q, t[2], t[0]);
    if (ab == 0 || bc == 0 || ca == 0) return std::nullopt;
    return ab == bc && bc == ca;
}

}  // namespace

bool is_closed(const TriangleMesh& mesh) {
    const Adjacency adjacency(mesh);
    for (Index e = 0; e < adjacency.edges(); ++e) {
        if (adjacency.triangles(e).size() % 2 != 0) return false;
    }
    return true;
}

// The error bound is from Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric predicates,
// 1997, section 4.3. With u = 2^-53 and this order of operations, the determinant errs by at most (7 + 56u) u times the
// sum of the absolute values of its products. This sum, `permanent`, is itself rounded by a few u, so 8u * permanent is
// enough. Underflow costs less than 2^-1000 if no product overflows. If one overflows, both comparisons are false, and
// the sign stays undecided.
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Vec3 p = a - d, q = b - d, r = c - d;
    const double qr = q[0] * r[1], rq = r[0] * q[1], rp = r[0] * p[1], pr = p[0] * r[1], pq = p[0] * q[1],
                 qp = q[0] * p[1];
    const double determinant = p[2] * (qr - rq) + q[2] * (rp - pr) + r[2] * (pq - qp);
    const double permanent = (std::abs(qr) + std::abs(rq)) * std::abs(p[2]) +
                             (std::abs(rp) + std::abs(pr)) * std::abs(q[2]) +
                             (std::abs(pq) + std::abs(qp)) * std::abs(r[2]);
    const double error =
        WATCHED("lemma 4: the sign of a determinant is proven", 8 * unit_roundoff * permanent + 0x1p-1000);
    return determinant > error ? 1 : -determinant > error ? -1 : 0;
}

template <class Tree> double EnclosedMove<Tree>::upper(const PieceCorners& corners, int level, double length) {
    const MeasuredPoint& far = *std::max_element(corners.begin(), corners.end(),
                                                 [](const auto& a, const auto& b) { return a.squared < b.squared; });
    const Vec3 towards = target_.closest(far.point, far.triangle, counters_).point - far.point;
    const double distance = std::sqrt(squared_length(towards));
    if (!(distance > 0 && length >= distance)) return infinity;
    return upper({corners[0].point, corners[1].point, corners[2].point}, level, towards * (length / distance));
}

template <class Tree> double EnclosedMove<Tree>::upper(const Corners& corners, int level, const Vec3& move) {
    const double length = distance_at_most(squared_length(move), true), n = magnitude_ + length;
    const double margin = (WATCHED("lemma 4: pieces are apart by more than their level", 4 * level) +
                           WATCHED("lemma 4: pieces are apart by more than rounding", 48)) *
                          unit_roundoff * n;
    const Corners moved{corners[0] + move, corners[1] + move, corners[2] + move};
    // The point of the piece whose path is tested for crossings with B. Its uneven weights make it unlikely to hit an
    // edge of B exactly, where rounding leaves the result undecided; corners and the barycentre often do.
    const Vec3 p = 0.5 * corners[0] + 0.3 * corners[1] + 0.2 * corners[2];
    const std::array<Vec3, 2> segment{p, p + move};
    // Search a ball around `centre` that contains the piece before, during and after its move. Its radius is enlarged
    // by one `margin` to find the triangles of B within `margin` of the piece, and by another to absorb rounding
    // errors.
    const Vec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    double radius = 0;
    for (const Vec3& corner : corners) radius = std::max(radius, squared_length(corner - middle));
    double search_radius =
        WATCHED("lemma 4: all that the piece may touch is looked at", distance_at_most(radius, true)) + 0.5 * length +
        WATCHED("lemma 4: all that the piece may touch is looked at", 2 * margin);
    const Vec3 centre = middle + 0.5 * move;
    std::size_t near = 0;
    bool odd = false, clear = true;
    ++counters_.bound_tests;
    visit_near_leaves(tree_, centre, search_radius, counters_, [&](std::size_t leaf) {
        double squared[3][leaf_capacity];
        unsigned mask = tree_.leaf_distances(leaf, corners, centre,
                                             search_radius * search_radius * (1 + 8 * unit_roundoff), squared);
        near += static_cast<std::size_t>(std::popcount(mask));
        if (near > most_near_move) clear = false;
        for (; clear && mask != 0; mask &= mask - 1) {
            const Index i = tree_.tree().leaf(leaf)[static_cast<std::size_t>(std::countr_zero(mask))];
            const Triangle t = target_.triangle(i);
            const Corners triangle{t.a, t.b, t.c};
            clear = WATCHED_ELSE("lemma 4: the piece does not touch B", apart(corners, triangle, margin), true) &&
                    WATCHED_ELSE("lemma 4: the moved piece does not touch B", apart(moved, triangle, margin), true);
            if (!clear) break;
            const std::optional<bool> crossing = crosses(segment, triangle, margin);
            if (WATCHED("lemma 4: an open answer of a crossing counts", true)) clear = crossing.has_value();
            if (crossing.value_or(false)) odd = !odd;
        }
        if (!clear) search_radius = -1;  // ends the walk
    });
    counters_.point_triangle_distances += 3 * near;
    return clear && WATCHED_ELSE("lemma 4: B is crossed an odd number of times", odd, true) ? length : infinity;
}

template class EnclosedMove<SweptSphereBvh>;
template class EnclosedMove<TriangleBvh>;

}  // namespace hausbench::tang
