// What guthe's parameters are for: without certification little changes, with the textbook kernel bounds go wrong.
#include "kernel/rounding.h"
#include "reference.h"
#include "registry.h"
#include "scenes.h"
#include "session.h"
#include "triangle_samples.h"

#include <gtest/gtest.h>

namespace hausbench {
namespace {

Result solve(const Scene& scene, double tolerance, const ParameterMap& given) {
    const SolverEntry& guthe = find_solver("guthe");
    const Session session(guthe, Options("guthe", guthe.info.parameters, given), scene, {});
    Query query;
    query.tolerance = {Tolerance::Of::absolute, tolerance};
    Trace trace;
    return session.solve(query, trace);
}

TEST(Guthe, IsCertifiedOnlyWhereItAccountsForRounding) {
    const SolverEntry& guthe = find_solver("guthe");
    const auto certified = [&](const ParameterMap& given) {
        return guthe.make(Options("guthe", guthe.info.parameters, given))->certified();
    };
    EXPECT_TRUE(certified({}));
    EXPECT_FALSE(certified({{"certify", false}}));
    EXPECT_FALSE(certified({{"kernel", "textbook"}}));
}

TEST(Guthe, CertificationChangesBoundsByRoundingOnly) {
    Random random(1);
    for (int i = 0; i < 20; ++i) {
        const Scene scene{soup(cloud(random, 30)), soup(cloud(random, 3 * (5 + 10 * i)))};
        const Result with = solve(scene, 1e-6, {}), without = solve(scene, 1e-6, {{"certify", false}});
        EXPECT_EQ(to_string(with.status), "converged");
        EXPECT_NEAR(with.bounds.lower, without.bounds.lower, 1e-6);
        EXPECT_NEAR(with.bounds.upper, without.bounds.upper, 1e-6);
        EXPECT_GE(with.bounds.upper, without.bounds.lower);
        EXPECT_LE(with.bounds.lower, without.bounds.upper);
    }
}

// A tolerance below what doubles can certify: the status says so, the bounds are as tight as rounding allows, and hold.
TEST(Guthe, AToleranceBelowRoundingIsThePrecisionFloor) {
    Random random(4);
    for (const double offset : {0.0, 1e8}) {
        const Vec3 far(offset, -offset, offset);
        const auto moved = [&](TriangleMesh mesh) {
            mesh.vertices.rowwise() += far.transpose();
            return mesh;
        };
        for (int i = 0; i < 10; ++i) {
            const Scene scene{moved(soup(cloud(random, 12))), moved(soup(cloud(random, 3 * (2 + 10 * i))))};
            const auto& source = std::get<TriangleMesh>(scene.source);
            const double unit =
                unit_roundoff * std::max(magnitude(source.vertices), magnitude(points_of(scene.target)));
            const Result result = solve(scene, 1e-3 * unit, {});
            EXPECT_EQ(to_string(result.status), "precision_floor") << i;
            EXPECT_GT(result.bounds.gap(), 1e-3 * unit);
            EXPECT_LT(result.bounds.gap(), 400 * unit) << "the floor is higher than rounding";
            const auto [low, high] =
                MeshReference(std::get<TriangleMesh>(scene.target)).hausdorff(source.vertices, source.triangles, 1e-7L);
            EXPECT_LE(result.bounds.lower, high);
            EXPECT_GE(result.bounds.upper, low);
        }
        const Scene same{moved(soup(cloud(random, 90))), moved(soup(cloud(random, 90)))};
        const Scene identical{same.source, same.source};
        EXPECT_EQ(to_string(solve(identical, 1e-20, {}).status), "precision_floor");
        EXPECT_EQ(to_string(solve(identical, 1e-9 * std::max(1.0, offset), {}).status), "converged");
    }
}

// Three corners on a line but for rounding: of the point nearest to one in 250 points, a textbook is wrong by the size of
// the triangle.
Scene rounded_collinear(Random& random) {
    const Triangle t = thin(random, 0, random.real(0.1, 0.9));
    return {soup(cloud(random, 90)), soup(rows({t.a, t.b, t.c}))};
}

TEST(Guthe, TheTextbookKernelGoesWrong) {
    Random random(2);
    int wrong = 0;
    for (int i = 0; i < 500; ++i) {
        const Scene scene = rounded_collinear(random);
        const auto& source = std::get<TriangleMesh>(scene.source);
        const auto [low, high] =
            MeshReference(std::get<TriangleMesh>(scene.target)).hausdorff(source.vertices, source.triangles, 1e-6L);
        const Result robust = solve(scene, 1e-6, {});
        EXPECT_LE(robust.bounds.lower, high);
        EXPECT_GE(robust.bounds.upper, low);
        const Result textbook = solve(scene, 1e-6, {{"kernel", std::string("textbook")}, {"certify", false}});
        if (textbook.bounds.lower > high + 1e-5L || textbook.bounds.upper < low - 1e-5L) ++wrong;
    }
    EXPECT_GT(wrong, 0) << "the scene does not show what it is for";
    std::cout << wrong << " of 500 intervals of the textbook kernel miss the distance\n";
}

TEST(Guthe, TheTextbookKernelAgreesOnTameMeshes) {
    Random random(3);
    for (const Index triangles : {10, 200}) {
        const Scene scene{soup(cloud(random, 30)), soup(cloud(random, 3 * triangles))};
        const Result robust = solve(scene, 1e-6, {}),
                     textbook = solve(scene, 1e-6, {{"kernel", std::string("textbook")}});
        EXPECT_NEAR(robust.bounds.lower, textbook.bounds.lower, 1e-6);
        EXPECT_NEAR(robust.bounds.upper, textbook.bounds.upper, 1e-6);
    }
}

}  // namespace
}  // namespace hausbench
