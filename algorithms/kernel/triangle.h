// A triangle, given by its corners.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/geometry.h"

namespace hausbench {

struct Triangle {
    Vec3 a, b, c;
};

inline Triangle triangle_of(const TriangleMesh& mesh, Index triangle) {
    const auto corners = mesh.triangles.row(triangle);
    return {mesh.vertices.row(corners[0]), mesh.vertices.row(corners[1]), mesh.vertices.row(corners[2])};
}

// Not Eigen's dot(), because the order of the additions, and with it the rounding, must always be the same.
inline double dot(const Vec3& x, const Vec3& y) { return (x[0] * y[0] + x[1] * y[1]) + x[2] * y[2]; }
inline double squared_length(const Vec3& x) { return dot(x, x); }

inline Box box_of(const Triangle& t) {
    Box box;
    box.low = t.a.cwiseMin(t.b).cwiseMin(t.c);
    box.high = t.a.cwiseMax(t.b).cwiseMax(t.c);
    return box;
}

// Returns which edge is the longest: 0 for ab, 1 for bc, 2 for ca.
inline int longest_edge(const Triangle& t) {
    const double ab = squared_length(t.b - t.a), bc = squared_length(t.c - t.b), ca = squared_length(t.a - t.c);
    if (bc > ab && bc >= ca) return 1;
    return ca > ab ? 2 : 0;
}

// Returns the same triangle with its corners rotated cyclically, so that ab is the longest edge.
inline Triangle longest_edge_first(const Triangle& t) {
    const int edge = longest_edge(t);
    if (edge == 1) return {t.b, t.c, t.a};
    if (edge == 2) return {t.c, t.a, t.b};
    return t;
}

}  // namespace hausbench
