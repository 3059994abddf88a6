// Small pairs of meshes that are hard for a search, and the conditions that their intervals must satisfy.
#pragma once

#include "algorithms/solver.h"
#include "tests/support/reference.h"
#include "tests/support/scenes.h"
#include "tests/support/triangle_samples.h"

#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace hausbench {

// Returns one of ten kinds in turn: thin triangles, duplicates, parallel sheets, equal meshes, mixed scales and others.
inline Scene small_scene(Random& random, int i) {
    TriangleMesh a = soup(cloud(random, 3 * (1 + i % 4))), b = soup(cloud(random, 3 * (1 + i / 3 % 8)));
    const auto thin_ones = [&](Index count, double height) {
        Points points(3 * count, 3);
        for (Index k = 0; k < count; ++k) {
            const Triangle t = thin(random, height, random.below(2) ? 0 : random.unit());
            points.row(3 * k) = t.a, points.row(3 * k + 1) = t.b, points.row(3 * k + 2) = t.c;
        }
        return soup(points);
    };
    switch (i % 10) {
        case 0:
            a = thin_ones(2, 1e-3);
            break;
        case 1:
            b = thin_ones(6, 1e-6);
            break;
        case 2:
            a.triangles.row(a.triangles.rows() - 1) = a.triangles.row(0).eval();
            break;  // duplicate, unused vertices
        case 3:
            a = sheet(3, 0.1, 0.1), b = sheet(4, 0, 0.2);
            break;
        case 4:
            a = sheet(3, 0.125), b = sheet(3, 0);
            break;
        case 5:
            b = a;
            break;
        case 6:
            a.vertices *= 1e-3;
            break;
        case 7:
            a = thin_ones(1, 0), b = thin_ones(4, 0);
            break;
        case 8:
            b = a, b.vertices.array() += 1e-3 * random.real(-1, 1);
            break;
        default:
            break;
    }
    return {a, b};
}

inline void expect_sound(const Result& result, std::pair<long double, long double> truth, double tolerance,
                         const std::string& where) {
    EXPECT_LE(result.bounds.lower, result.bounds.upper) << where;
    EXPECT_LE(result.bounds.lower, truth.second) << where;
    EXPECT_GE(result.bounds.upper, truth.first) << where;
    EXPECT_TRUE(result.status != Status::converged || result.bounds.gap() <= tolerance) << where;
}

inline std::pair<long double, long double> truth_of(const Scene& scene) {
    const auto& a = mesh_of(scene.source);
    return MeshReference(mesh_of(scene.target)).hausdorff(a.vertices, a.triangles, 1e-5L);
}

}  // namespace hausbench
