// Slow, independent reference answers for solvers; they share no code with the solvers.
#pragma once

#include "algorithms/scene.h"
#include "tests/support/exact.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace hausbench {

// Returns h(A,B)^2 of two point sets exactly, in O(nm) rational operations.
inline exact::Rational exact_squared_hausdorff(const Points& a, const Points& b) {
    exact::Rational most = 0;
    for (Index i = 0; i < a.rows(); ++i) {
        const exact::RVec3 p = exact::vector(a.row(i));
        exact::Rational least = exact::squared_distance(p, exact::vector(b.row(0)));
        for (Index j = 1; j < b.rows(); ++j)
            least = std::min(least, exact::squared_distance(p, exact::vector(b.row(j))));
        most = std::max(most, least);
    }
    return most;
}

// A reference for meshes: plain branch and bound in long double (64-bit mantissa, 15-bit exponent,
// so nothing over- or underflows). Each distance tries every triangle of the target.
class MeshReference {
public:
    using Real = long double;
    using V = std::array<Real, 3>;

    explicit MeshReference(const TriangleMesh& target) {
        for (Index i = 0; i < target.triangles.rows(); ++i)
            targets_.push_back(corners(target.vertices, target.triangles, i));
    }

    // Returns an interval that contains h(a, target) and whose width is at most `gap`.
    std::pair<Real, Real> hausdorff(const Points& vertices, const Triangles& triangles, Real gap) const {
        std::vector<Piece> stack;
        Real low = 0;
        for (Index i = 0; i < triangles.rows(); ++i) stack.push_back(piece(corners(vertices, triangles, i), low));
        // All lower bounds are known before the first split, and the largest upper bound comes first, so that few
        // pieces are split.
        std::sort(stack.begin(), stack.end(), [](const Piece& x, const Piece& y) { return x.upper < y.upper; });
        Real high = low;
        while (!stack.empty()) {
            const Piece top = stack.back();
            stack.pop_back();
            if (top.upper <= low + gap / 2) {
                high = std::max(high, top.upper);
                continue;
            }
            const auto& [a, b, c] = top.corners;
            const V ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            for (const auto& corners : {std::array<V, 3>{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}}) {
                stack.push_back(piece(corners, low));
            }
        }
        return {low, std::max(low, high)};
    }

    Real distance(const V& p) const {
        Real least = std::numeric_limits<Real>::infinity();
        for (const auto& t : targets_) least = std::min(least, to_triangle(p, t));
        return std::sqrt(least);
    }

    static V vector(const Vec3& v) { return {v[0], v[1], v[2]}; }

private:
    using Corners = std::array<V, 3>;
    struct Piece {
        Corners corners;
        Real upper;
    };

    static Corners corners(const Points& vertices, const Triangles& triangles, Index i) {
        return {vector(vertices.row(triangles(i, 0))), vector(vertices.row(triangles(i, 1))),
                vector(vertices.row(triangles(i, 2)))};
    }
    static V minus(const V& a, const V& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
    static V middle(const V& a, const V& b) { return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2}; }
    static Real dot(const V& a, const V& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

    static Real to_segment(const V& p, const V& a, const V& b) {
        const V d = minus(b, a), r = minus(p, a);
        const Real length = dot(d, d);
        const Real t = length > 0 ? std::clamp<Real>(dot(r, d) / length, 0, 1) : 0;
        const V q = minus(r, {t * d[0], t * d[1], t * d[2]});
        return dot(q, q);
    }
    static Real to_triangle(const V& p, const Corners& t) {
        const auto& [a, b, c] = t;
        Real least = std::min({to_segment(p, a, b), to_segment(p, b, c), to_segment(p, c, a)});
        const V e = minus(b, a), f = minus(c, a);
        const Real ee = dot(e, e), ef = dot(e, f), ff = dot(f, f), det = ee * ff - ef * ef;
        if (!(det > 0)) return least;
        V r = minus(p, a);
        Real s = 0, u = 0;
        for (int step = 0; step < 3; ++step) {  // refined, because the normal equations are ill-conditioned
            const Real re = dot(r, e), rf = dot(r, f);
            s += (re * ff - rf * ef) / det;
            u += (rf * ee - re * ef) / det;
            r = minus(minus(p, a), {s * e[0] + u * f[0], s * e[1] + u * f[1], s * e[2] + u * f[2]});
        }
        return s >= 0 && u >= 0 && s + u <= 1 ? std::min(least, dot(r, r)) : least;
    }

    Piece piece(const Corners& corners, Real& low) const {
        Real farthest_all = std::numeric_limits<Real>::infinity();
        std::array<Real, 3> nearest;
        nearest.fill(farthest_all);
        for (const Corners& t : targets_) {
            Real farthest = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const Real d = to_triangle(corners[k], t);
                nearest[k] = std::min(nearest[k], d);
                farthest = std::max(farthest, d);
            }
            farthest_all = std::min(farthest_all, farthest);
        }
        Real upper = std::sqrt(farthest_all);
        for (std::size_t k = 0; k < 3; ++k) {
            const Real d = std::sqrt(nearest[k]);
            low = std::max(low, d);
            Real edge = 0;
            for (const V& other : corners)
                edge = std::max(edge, dot(minus(other, corners[k]), minus(other, corners[k])));
            upper = std::min(upper, d + std::sqrt(edge));
        }
        return {corners, upper};
    }

    std::vector<Corners> targets_;
};

}  // namespace hausbench
