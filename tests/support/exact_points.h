// The exact distance from a triangle to a few points, and these points as a mesh.
#pragma once

#include "algorithms/kernel/point_triangle.h"
#include "tests/support/exact.h"
#include "tests/support/scenes.h"

#include <algorithm>
#include <vector>

namespace hausbench {

// Returns h(A,B)^2 for one triangle A and a few points B. In the part of A nearest to one point of B, the farthest
// point is a corner of that part: a corner of A, a point on an edge equally far from two points of B, or a point
// equally far from three.
inline exact::Rational exact_squared(const Triangle& a, const std::vector<Vec3>& b) {
    using exact::Rational;
    using exact::RVec3;
    using exact::operator-;
    const RVec3 corner[3] = {exact::vector(a.a), exact::vector(a.b), exact::vector(a.c)};
    std::vector<RVec3> points;
    for (const Vec3& point : b) points.push_back(exact::vector(point));
    std::vector<RVec3> candidates(corner, corner + 3);
    // Squared distance to point i minus squared distance to point j: linear in x, and 0 if x is equally far.
    const auto difference = [&](const RVec3& x, std::size_t i, std::size_t j) {
        return Rational(exact::squared_distance(x, points[i]) - exact::squared_distance(x, points[j]));
    };
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            for (int k = 0; k < 3; ++k) {
                const RVec3 &from = corner[k], &to = corner[(k + 1) % 3];
                const Rational f = difference(from, i, j), g = difference(to, i, j);
                if (f != g && f * g <= 0) candidates.push_back(exact::along(from, f / (f - g), to - from));
            }
            for (std::size_t l = 0; l < j; ++l) {
                const RVec3 e = corner[1] - corner[0], f = corner[2] - corner[0];
                const Rational p = difference(corner[0], i, j), pe = difference(corner[1], i, j) - p,
                               pf = difference(corner[2], i, j) - p;
                const Rational q = difference(corner[0], i, l), qe = difference(corner[1], i, l) - q,
                               qf = difference(corner[2], i, l) - q;
                const Rational det = pe * qf - pf * qe;
                if (det == 0) continue;
                const Rational s = (pf * q - p * qf) / det, t = (p * qe - pe * q) / det;
                if (s < 0 || t < 0 || s + t > 1) continue;
                candidates.push_back(exact::along(exact::along(corner[0], s, e), t, f));
            }
        }
    }
    Rational most = 0;
    for (const RVec3& x : candidates) {
        Rational least = exact::squared_distance(x, points[0]);
        for (const RVec3& y : points) least = std::min(least, exact::squared_distance(x, y));
        most = std::max(most, least);
    }
    return most;
}

inline TriangleMesh points_as_triangles(const std::vector<Vec3>& points) {
    Points corners(static_cast<Index>(3 * points.size()), 3);
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) corners.row(static_cast<Index>(3 * i + k)) = points[i];
    }
    return soup(corners);
}

}  // namespace hausbench
