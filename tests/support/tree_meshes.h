// Meshes, tame and hostile, for tests of trees.
#pragma once

#include "tests/support/random.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace hausbench {

inline TriangleMesh triangle_soup(Random& random, Index count, double size) {
    TriangleMesh mesh;
    mesh.vertices.resize(3 * count, 3);
    mesh.triangles.resize(count, 3);
    for (Index i = 0; i < count; ++i) {
        const Vec3 centre = random.vector();
        for (int k = 0; k < 3; ++k) {
            mesh.vertices.row(3 * i + k) = centre + random.vector(size);
            mesh.triangles(i, k) = 3 * i + k;
        }
    }
    return mesh;
}

// A grid of n x n vertices with heights up to `bump`: most closest points lie on shared edges and vertices.
inline TriangleMesh triangle_grid(Random& random, Index n, double bump) {
    TriangleMesh mesh;
    mesh.vertices.resize(n * n, 3);
    mesh.triangles.resize(2 * (n - 1) * (n - 1), 3);
    for (Index i = 0; i < n * n; ++i)
        mesh.vertices.row(i) = Vec3(0.125 * (i % n), 0.125 * (i / n), bump * random.unit());
    Index t = 0;
    for (Index y = 0; y + 1 < n; ++y) {
        for (Index x = 0; x + 1 < n; ++x) {
            const Index v = n * y + x;
            mesh.triangles.row(t++) << v, v + 1, v + n;
            mesh.triangles.row(t++) << v + 1, v + n + 1, v + n;
        }
    }
    return mesh;
}

using NamedMesh = std::pair<std::string, TriangleMesh>;

inline std::vector<NamedMesh> tree_meshes() {
    Random random(3);
    std::vector<NamedMesh> all;
    const auto add = [&](const std::string& name, TriangleMesh mesh) -> TriangleMesh& {
        all.emplace_back(name, std::move(mesh));
        return all.back().second;
    };
    add("one triangle", triangle_soup(random, 1, 0.5));
    add("eight triangles", triangle_soup(random, 8, 0.5));
    add("small triangles", triangle_soup(random, 3000, 0.02));
    add("large triangles", triangle_soup(random, 300, 0.7));
    TriangleMesh& duplicates = add("duplicates", triangle_soup(random, 100, 0.1));
    for (Index i = 0; i < 60; ++i) duplicates.triangles.row(i) = duplicates.triangles.row(70);
    add("points", triangle_soup(random, 100, 0));
    add("all in one point", triangle_soup(random, 400, 0)).vertices.setConstant(0.25);
    add("sizes 1 : 1e9", triangle_soup(random, 200, 1e-9)).vertices.topRows(30) *= 1e-9;
    add("a plane", triangle_soup(random, 500, 0.1)).vertices.col(2).setConstant(0.5);
    add("grid", triangle_grid(random, 10, 0));
    add("far from the origin", triangle_soup(random, 300, 0.1)).vertices.array() += 1e8;
    add("tiny", triangle_soup(random, 300, 0.1)).vertices *= 0x1p-380;
    add("huge", triangle_soup(random, 300, 0.1)).vertices *= 0x1p399;
    // Triangles that shrink towards one corner make deep trees.
    TriangleMesh& nested = add("nested", triangle_soup(random, 300, 0.5));
    for (Index i = 0; i < nested.vertices.rows(); ++i)
        nested.vertices.row(i) *= std::ldexp(1.0, -static_cast<int>(i / 9));
    for (int i = 0; all.size() < 200; ++i) {
        const Index count = 1 + random.below(60);
        const std::string name = "random " + std::to_string(i);
        if (i % 3 == 0) add(name, triangle_grid(random, 2 + count / 6, 0.1));
        if (i % 3 == 1) add(name, triangle_soup(random, count, std::ldexp(1.0, -random.below(14))));
        if (i % 3 == 2) {  // shared corners, needles, overlaps
            TriangleMesh& mesh = add(name, triangle_soup(random, count, 0.2));
            for (Index t = 0; t < mesh.triangles.rows(); ++t) {
                for (int k = 0; k < 3; ++k) mesh.triangles(t, k) = random.below(std::min<Index>(3 * count, 20));
            }
        }
    }
    return all;
}

inline Vec3 query_near(const TriangleMesh& mesh, Random& random) {
    const Index v = random.below(static_cast<Index>(mesh.vertices.rows()));
    const Vec3 vertex = mesh.vertices.row(v);
    const double size = mesh.vertices.cwiseAbs().maxCoeff();
    switch (random.below(6)) {
        case 0:
            return random.vector(2 * size);
        case 1:
            return vertex;
        case 2:
            return vertex + random.vector(1e-7 * size);
        case 3:
            return vertex + random.vector(std::ldexp(1.0, random.below(200)));
        case 4:
            return 0.5 * (vertex + Vec3(mesh.vertices.row(random.below(static_cast<Index>(mesh.vertices.rows())))));
        default:
            return Vec3(0.0625 * random.below(32), 0.0625 * random.below(32), 0.25 * random.below(3));
    }
}

}  // namespace hausbench
