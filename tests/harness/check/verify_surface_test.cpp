// The check of lower bounds on algebraic surfaces must accept true bounds and refute wrong ones.
#include "harness/check/verify_surface.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/scenes.h"

#include <cmath>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

const AlgebraicSurface ball = surface_in_cube("x^2 + y^2 + z^2 - 1"), large = surface_in_cube("x^2 + y^2 + z^2 - 9/4");
const AlgebraicSurface cone_1 = surface_in_cube("x^2/4 + y^2/4 - z^2/9"),
                       cone_2 = surface_in_cube("x^2/16 + y^2/4 - z^2/9");

Verdict check(const AlgebraicSurface& a, const AlgebraicSurface& b, double lower, const Vec3& p) {
    double shown = 0;
    return check_surface_lower(a, b, lower, p, shown);
}

TEST(SurfaceCheck, TellsRightFromWrong) {
    const Vec3 p(0, 0, 1);
    EXPECT_EQ(check(ball, large, 0.4999, p), Verdict::holds);
    EXPECT_EQ(check(ball, large, 0.5 - 1e-9, p), Verdict::holds);
    EXPECT_EQ(check(ball, large, 0.51, p), Verdict::unsound);
    EXPECT_EQ(check(ball, large, 0.6, p), Verdict::unsound);
    EXPECT_NE(check(ball, large, 0.1 + 1e-9, Vec3(0, 0, 1.2)), Verdict::holds);   // the witness is 0.2 from A
    EXPECT_EQ(check(ball, large, 0.1, Vec3(0, 0, 3)), Verdict::unsound);          // the witness is outside A's box
    const AlgebraicSurface squared = surface_in_cube("(x^2 + y^2 + z^2 - 1)^2");  // nowhere negative
    EXPECT_EQ(check(squared, large, 0.1, p), Verdict::holds);                     // p is a zero
    EXPECT_EQ(check(squared, large, 0.1, Vec3(0, 0, 0.7)), Verdict::unsound);
}

// A witness slightly off A loses exactly its distance from A.
TEST(SurfaceCheck, TakesOffHowFarTheWitnessIsBeside) {
    const double beside = 3e-5;
    const Vec3 p(0, 0, 1 - beside);
    EXPECT_EQ(check(ball, large, 0.5 - 1e-9, p), Verdict::holds);  // 0.5 + beside from B, minus beside
    EXPECT_NE(check(ball, large, 0.5 + 0.5 * beside, p), Verdict::holds);
}

// A witness far from A, for example from a coarse mesh, still proves a smaller lower bound.
TEST(SurfaceCheck, AWitnessFarFromTheSurfaceShowsWhatIsLeft) {
    EXPECT_EQ(check(ball, large, 0.3 - 1e-9, Vec3(0, 0, 0.9)), Verdict::holds);  // less than 0.6 - 0.1
    EXPECT_NE(check(ball, large, 0.5 + 1e-9, Vec3(0, 0, 0.9)), Verdict::holds);
}

// At the apex, no line parallel to an axis crosses the cone.
TEST(SurfaceCheck, TheApexOfACone) {
    EXPECT_EQ(check(cone_1, large, 1.4999, Vec3::Zero()), Verdict::holds);
    EXPECT_EQ(check(cone_1, large, 1.4999, Vec3(0, 0, 1e-6)), Verdict::holds);
    EXPECT_EQ(check(cone_1, large, 1.51, Vec3::Zero()), Verdict::unsound);
    EXPECT_NE(check(cone_1, large, 1.29, Vec3(0, 0, 0.2)), Verdict::holds);  // 1.3 from B, but 0.11 off the cone
}

// Some targets are clipped by their box, so the nearest point may lie on a side of the box.
TEST(SurfaceCheck, SettlesEveryWitnessOfTheEnclosure) {
    const AlgebraicSurface ellipsoid = surface_in_cube("x^2/2.25 + y^2 + z^2 - 1"),
                           torus = surface_in_cube("(x^2 + y^2 + z^2 + 3/4)^2 - 4*(x^2 + y^2)");
    const AlgebraicSurface plane = surface_in_cube("z"), crossing = surface_in_cube("x*y"),
                           slanted = surface_in_cube("z - x/4");
    const SolverEntry& entry = find_solver("surface_enclosure");
    for (const auto& [a, b] : {std::pair{cone_1, cone_2},
                               {cone_2, cone_1},
                               {ellipsoid, ball},
                               {torus, ball},
                               {cone_1, plane},
                               {crossing, plane},
                               {plane, slanted}}) {
        const Session session(entry, Options(entry.info.name, entry.info.parameters, {}), {a, b}, {});
        for (const double tolerance : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10}) {
            Query query;
            query.tolerance = {Tolerance::Of::absolute, tolerance};
            query.time_limit = 0.25;
            Trace trace;
            const Result result = session.solve(query, trace);
            const std::string where =
                a.polynomial + " to " + b.polynomial + " at " + std::to_string(-std::log10(tolerance));
            EXPECT_EQ(to_string(check(a, b, result.bounds.lower, result.witness.source_point)), "holds") << where;
            // A bound above the distance never holds.
            EXPECT_NE(check(a, b, result.bounds.upper * (1 + 1e-12) + 1e-12, result.witness.source_point),
                      Verdict::holds)
                << where;
        }
    }
}

}  // namespace
}  // namespace hausbench
