// 5,000 random pairs of small meshes. The interval of every certified mesh solver, with each option in turn, must agree
// with two slow references and with all other solvers.
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/exact.h"
#include "tests/support/quick_options.h"
#include "tests/support/searches.h"
#include "tests/support/small_scenes.h"

#include <map>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using exact::Rational;

// Returns a scene large enough for trees and groups of triangles. B is similar to A, far away, slightly stretched,
// random, or much smaller.
Scene middling_scene(Random& random, int i) {
    const Index n = 5 + random.below(3), m = 5 + random.below(3);
    TriangleMesh a = sheet(n, 0, 0.5), b = sheet(m, 0.25, 0.25);
    b.vertices *= static_cast<double>(n - 1) / (m - 1);
    switch (i / 10 % 5) {
        case 0:
            break;
        case 1:
            b.vertices.col(0).array() += 20;
            break;
        case 2:
            b = a, b.vertices.col(2) *= 1.01;
            break;
        case 3:
            a = soup(cloud(random, 3 * 36)), b = soup(cloud(random, 3 * 36));
            break;
        default:
            b.vertices *= 1e-3;
            break;
    }
    return {a, b};
}

// Returns the exact squared distance from B of the farthest grid point (i * a + j * b + k * c) / n on the triangles of
// A.
Rational exact_squared_at_samples(const TriangleMesh& a, const TriangleMesh& b, int n) {
    using exact::operator-;
    Rational most = 0;
    for (Index t = 0; t < a.triangles.rows(); ++t) {
        const Triangle triangle = triangle_of(a, t);
        const exact::RVec3 o = exact::vector(triangle.a), e = exact::vector(triangle.b) - o,
                           f = exact::vector(triangle.c) - o;
        for (int i = 0; i <= n; ++i) {
            for (int j = 0; i + j <= n; ++j) {
                const exact::RVec3 p = exact::along(exact::along(o, Rational(i) / n, e), Rational(j) / n, f);
                Rational least = -1;
                for (Index s = 0; s < b.triangles.rows(); ++s) {
                    const Triangle near = triangle_of(b, s);
                    const Rational squared = exact::squared_distance_to_triangle(
                        p, exact::vector(near.a), exact::vector(near.b), exact::vector(near.c));
                    if (least < 0 || squared < least) least = squared;
                }
                most = std::max(most, least);
            }
        }
    }
    return most;
}

// Returns slightly more than the largest distance between a point of `a` and its nearest grid point.
double covering_radius(const TriangleMesh& a, int n) {
    double longest = 0;
    for (Index t = 0; t < a.triangles.rows(); ++t) {
        const Triangle v = triangle_of(a, t);
        longest = std::max({longest, (v.a - v.b).norm(), (v.b - v.c).norm(), (v.c - v.a).norm()});
    }
    return 0.5774 * longest / n;
}

std::vector<const SolverEntry*> mesh_solvers() {
    std::vector<const SolverEntry*> chosen;
    for (const SolverEntry& entry : solvers()) {
        if (entry.info.certified && entry.info.source.mesh && entry.info.target.mesh &&
            entry.info.offers(Quantity::directed))
            chosen.push_back(&entry);
    }
    return chosen;
}

TEST(MeshSoups, IntervalsHoldBothReferencesAndOverlap) {
    Random random(2024);
    constexpr double tolerance = 1e-5;
    std::map<std::string, int> converged;
    int count = 0;
    for (int i = 0; i < tries(5000); ++i) {
        const bool large = i % 10 == 9;
        const Scene scene = large ? middling_scene(random, i) : small_scene(random, i);
        const TriangleMesh &a = mesh_of(scene.source), &b = mesh_of(scene.target);
        const auto truth = MeshReference(b).hausdorff(a.vertices, a.triangles, large ? 1e-2L : 1e-5L);
        double greatest_lower = 0, least_upper = std::numeric_limits<double>::infinity();
        for (const SolverEntry* entry : mesh_solvers()) {
            const auto variants = variants_of(*entry);
            const ParameterMap& given = variants[static_cast<std::size_t>(i) % variants.size()];
            const Options options = quick_options(*entry, given);
            if (!entry->make(options)->certified()) continue;
            Query query;
            query.tolerance = {Tolerance::Of::absolute, tolerance};
            query.budget = 2000;
            Trace trace;
            const Result result = Session(*entry, options, scene, {}).solve(query, trace);
            const std::string where =
                entry->info.name + (given.empty() ? "" : ", " + given.begin()->first) + ", scene " + std::to_string(i);
            expect_sound(result, truth, tolerance, where);
            greatest_lower = std::max(greatest_lower, result.bounds.lower);
            least_upper = std::min(least_upper, result.bounds.upper);
            converged[entry->info.name] += result.status == Status::converged;
        }
        ++count;
        EXPECT_LE(greatest_lower, least_upper) << "scene " << i;
        if (i % 20 != 3 && i % 20 != 10) continue;
        const int n = 4;
        const Rational squared = exact_squared_at_samples(a, b, n);
        EXPECT_TRUE(Rational(least_upper) * Rational(least_upper) >= squared) << "scene " << i;
        const Rational above = Rational(greatest_lower) - Rational(covering_radius(a, n));
        EXPECT_TRUE(above <= 0 || above * above <= squared) << "scene " << i;
    }
    for (const SolverEntry* entry : mesh_solvers()) {
        if (!reaches_the_tolerance(entry->info)) continue;
        EXPECT_GT(converged[entry->info.name], count / 2) << entry->info.name;
    }
}

}  // namespace
}  // namespace hausbench
