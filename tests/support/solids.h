// Closed meshes with outward faces.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <algorithm>
#include <map>
#include <utility>

namespace hausbench {

inline TriangleMesh box(const Vec3& low, const Vec3& high) {
    TriangleMesh mesh;
    mesh.vertices.resize(8, 3);
    for (int i = 0; i < 8; ++i)
        for (int k = 0; k < 3; ++k) mesh.vertices(i, k) = (i >> k & 1) != 0 ? high[k] : low[k];
    mesh.triangles.resize(12, 3);
    mesh.triangles << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5,
        3, 7, 5;
    return mesh;
}

inline TriangleMesh inside_out(TriangleMesh mesh) {
    mesh.triangles.col(0).swap(mesh.triangles.col(1));
    return mesh;
}

inline TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
    TriangleMesh both;
    both.vertices.resize(a.vertices.rows() + b.vertices.rows(), 3);
    both.vertices << a.vertices, b.vertices;
    both.triangles.resize(a.triangles.rows() + b.triangles.rows(), 3);
    both.triangles << a.triangles, (b.triangles.array() + Index(a.vertices.rows())).matrix();
    return both;
}

inline TriangleMesh scaled(TriangleMesh mesh, double factor) {
    mesh.vertices *= factor;
    return mesh;
}

// Returns an octahedron whose triangles are split into four `levels` times, with its vertices on the unit sphere.
inline TriangleMesh sphere(int levels) {
    TriangleMesh mesh;
    mesh.vertices.resize(6, 3);
    mesh.vertices << 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1;
    mesh.triangles.resize(8, 3);
    mesh.triangles << 0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5;
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<Index, Index>, Index> middles;
        const auto middle = [&](Index a, Index b) {
            const auto [at, fresh] = middles.emplace(std::minmax(a, b), Index(mesh.vertices.rows()));
            if (fresh) {
                mesh.vertices.conservativeResize(mesh.vertices.rows() + 1, 3);
                mesh.vertices.bottomRows(1) = (mesh.vertices.row(a) + mesh.vertices.row(b)).normalized();
            }
            return at->second;
        };
        Triangles finer(4 * mesh.triangles.rows(), 3);
        for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
            const Index a = mesh.triangles(t, 0), b = mesh.triangles(t, 1), c = mesh.triangles(t, 2);
            const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.middleRows(4 * t, 4) << a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca;
        }
        mesh.triangles = finer;
    }
    return mesh;
}

// Returns how far the mesh lies inside the unit sphere at most: 1 minus the least distance of a
// triangle's plane from the origin.
inline double sphere_flatness(const TriangleMesh& mesh) {
    double least = 1;
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
        const Vec3 a = mesh.vertices.row(mesh.triangles(t, 0)), b = mesh.vertices.row(mesh.triangles(t, 1)),
                   c = mesh.vertices.row(mesh.triangles(t, 2));
        least = std::min(least, std::abs((b - a).cross(c - a).normalized().dot(a)));
    }
    return 1 - least;
}

}  // namespace hausbench
