// The harness's own check of penetration depths: correct answers hold, and each kind of wrong answer is found.
#include "harness/check/verify_penetration.h"

#include "tests/support/solids.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using Direction = Witness::Direction;

Witness from_source(const Vec3& p) { return {p, Vec3::Constant(unknown), -1, -1, Direction::source_to_target}; }
Witness from_target(const Vec3& p) { return {Vec3::Constant(unknown), p, -1, -1, Direction::target_to_source}; }

Check check(const TriangleMesh& a, const TriangleMesh& b, const Bounds& bounds, const Witness& witness,
            const Pose& a_pose = {}, const Pose& b_pose = {}) {
    const Shape source = a, target = b;
    return PenetrationChecker(source, a_pose, target, b_pose).check(bounds, witness);
}

void expect(const Check& result, Verdict lower, Verdict upper, const std::string& reason = "") {
    EXPECT_EQ(result.lower, lower) << result.reason;
    EXPECT_EQ(result.upper, upper) << result.reason;
    EXPECT_NE(result.reason.find(reason), std::string::npos) << result.reason;
    EXPECT_EQ(result.reason.empty(), reason.empty()) << result.reason;
}

const TriangleMesh cube = box({0, 0, 0}, {1, 1, 1}), bar = box({0.5, 0.2, 0.2}, {2, 0.8, 0.8});
const Vec3 end(0.5, 0.5, 0.5);  // the middle of the bar's end, 0.5 from the cube's face

TEST(VerifyPenetration, RightAnswersHold) {
    expect(check(cube, bar, {0.5, 0.5}, from_target(end)), Verdict::holds, Verdict::holds);
    expect(check(bar, cube, {0.4999, 0.5}, from_source(end)), Verdict::holds, Verdict::holds);
    expect(check(cube, bar, {0.5 + 1e-11, 0.5}, from_target(end)), Verdict::holds,
           Verdict::holds);  // the excess may be due to rounded cut points
    expect(check(cube, box({4, 4, 4}, {5, 5, 5}), {0, 0}, from_source(Vec3::Constant(unknown))), Verdict::holds,
           Verdict::holds);
    expect(check(box({-1, -1, -1}, {1, 1, 1}), box({-3, -3, -3}, {3, 3, 3}), {2, 2}, from_source({1, 0.3, 0.2})),
           Verdict::holds, Verdict::holds);
}

// The depth of an enclosed part is its distance to the whole other mesh, including the mesh's part outside.
TEST(VerifyPenetration, Enclosed) {
    const TriangleMesh inner = box({-1, -1, -1}, {1, 1, 1}), outer = box({-3, -3, -3}, {3, 3, 3});
    for (const double wrong : {2.1, 3.0, 100.0})
        expect(check(inner, outer, {wrong, wrong}, from_source({1, 0.3, 0.2})), Verdict::unsound, Verdict::holds,
               "bounded 2");
    expect(check(outer, inner, {2, 2}, from_target({1, 0.3, 0.2})), Verdict::holds, Verdict::holds);
    expect(check(outer, inner, {1.9, 1.9}, from_target({1, 0.3, 0.2})), Verdict::holds, Verdict::unsound, "deeper");
    // Within the wall of a hollow box, the cavity bounds the part. The outside is nearer, but does not count.
    const TriangleMesh shell = joined(outer, inside_out(box({-2, -2, -2}, {2, 2, 2})));
    const double corner = 0.5 * std::sqrt(3.0);
    const Vec3 p(2.5, 2.5, 2.5);
    expect(check(box(-p, p), shell, {corner, corner}, from_source(p)), Verdict::holds, Verdict::holds);
    expect(check(box(-p, p), shell, {corner + 1e-3, 1}, from_source(p)), Verdict::unsound, Verdict::holds, "bounded");
}

// Thin slits separate the teeth: first one next to the witness, then one next to the nearer face of B.
TEST(VerifyPenetration, NarrowSlitsSeparate) {
    const TriangleMesh teeth = joined(box({0, 0, 0}, {1, 1, 4}), box({1.001, 0, 0}, {3.5, 1, 4}));
    const TriangleMesh slab = box({-5, -5, 1}, {3.4, 6, 9});
    expect(check(teeth, slab, {2.8, 4}, from_source({1, 0.5, 3.9})), Verdict::not_checked, Verdict::holds);
    const TriangleMesh late = joined(box({0, 0, 0}, {3.399, 1, 4}), box({3.3995, 0, 0}, {3.5, 1, 4}));
    EXPECT_NE(check(late, slab, {2.8, 4}, from_source({0, 0.5, 3.9})).lower, Verdict::unsound);
}

TEST(VerifyPenetration, TrianglesThatDoNotCount) {
    TriangleMesh twice = cube;
    twice.triangles.conservativeResize(15, 3);
    twice.triangles.row(12) = twice.triangles.row(10);  // the triangles through which a ray along x leaves
    twice.triangles.row(14) = twice.triangles.row(11);
    twice.vertices.conservativeResize(9, 3);
    twice.vertices.row(8) << 1, 0.5, 0.5;  // well within the bar
    twice.triangles.row(13) << 0, 0, 8;
    expect(check(twice, bar, {0.5, 0.5}, from_target(end)), Verdict::holds, Verdict::holds);
    expect(check(twice, bar, {0, 0.21}, from_target(end)), Verdict::holds, Verdict::holds);
}

// If squares of lengths underflow, nothing is claimed, and a correct answer is not refused.
TEST(VerifyPenetration, SolidsThatAreTiny) {
    for (const double s : {0x1p-490, 0x1p-537, 0x1p-600}) {
        const Check result = check(scaled(cube, s), scaled(bar, s), {0.5 * s, 0.5 * s}, from_target(s * end));
        EXPECT_EQ(result.lower, s > 0x1p-500 ? Verdict::holds : Verdict::not_checked) << s << result.reason;
        EXPECT_NE(result.upper, Verdict::unsound) << s << result.reason;
    }
}

TEST(VerifyPenetration, BoundsAndCoordinatesThatAreHuge) {
    const double infinity = std::numeric_limits<double>::infinity();
    expect(check(cube, bar, {infinity, infinity}, from_target(end)), Verdict::unsound, Verdict::holds, "infinite");
    expect(check(cube, bar, {0.5, infinity}, from_target(end)), Verdict::holds, Verdict::holds);
    expect(check(cube, bar, {-1, -0.5}, from_target(end)), Verdict::holds, Verdict::unsound, "at least 0");
    EXPECT_EQ(check(scaled(cube, 1e200), scaled(bar, 1e200), {1, 2}, from_target(end)).lower, Verdict::not_checked);
}

TEST(VerifyPenetration, ALowerBoundThatIsTooLarge) {
    expect(check(cube, bar, {0.51, 0.52}, from_target(end)), Verdict::unsound, Verdict::holds,
           "the same part of the volume is bounded 0.5");
    expect(check(cube, bar, {0.5 + 1e-8, 0.52}, from_target(end)), Verdict::unsound, Verdict::holds, "bounded 0.5");
    // The witness is a corner of the bar, so the path to the cube's face runs along an edge of the bar.
    expect(check(cube, bar, {0.51, 0.52}, from_target({0.5, 0.2, 0.2})), Verdict::unsound, Verdict::holds, "bounded");
}

TEST(VerifyPenetration, AWitnessThatIsNone) {
    expect(check(cube, bar, {0.5, 0.5}, from_target({0.4, 0.5, 0.5})), Verdict::unsound, Verdict::holds,
           "is not on its surface");
    expect(check(cube, bar, {0.5, 0.5}, from_target({2, 0.5, 0.5})), Verdict::unsound, Verdict::holds,
           "does not lie in the other solid");
    expect(check(cube, bar, {0.5, 0.5}, from_source(Vec3::Constant(unknown))), Verdict::no_witness, Verdict::holds);
}

TEST(VerifyPenetration, AnUpperBoundThatIsTooSmall) {
    // The corners of the bar's end are 0.2 from the cube's faces, so the depth is at least 0.2.
    expect(check(cube, bar, {0, 0.19}, from_target(end)), Verdict::holds, Verdict::unsound, "lies deeper");
    expect(check(bar, cube, {0, 0.19}, from_source(end)), Verdict::holds, Verdict::unsound, "lies deeper");
    expect(check(cube, bar, {0, 0.21}, from_target(end)), Verdict::holds, Verdict::holds);
    expect(check(cube, bar, {0.3, 0.21}, from_target(end)), Verdict::holds, Verdict::unsound, "below lower");
}

// A plane of B between two teeth of A is nearer, but does not bound the volume, because it does not lie in A.
TEST(VerifyPenetration, NearerTrianglesOutsideDoNotCount) {
    const TriangleMesh teeth = joined(box({0, 0, 0}, {1, 1, 2}), box({1.2, 0, 0}, {2.2, 1, 2}));
    const Vec3 side(0.9, 0.5, 2);
    expect(check(teeth, box({-5, -5, 1}, {1.1, 6, 4}), {0.9, 1.2}, from_source(side)), Verdict::holds, Verdict::holds);
    expect(check(teeth, box({-5, -5, 1}, {1.1, 6, 4}), {1.1, 1.2}, from_source(side)), Verdict::unsound, Verdict::holds,
           "same part");
    // With the plane inside the other tooth, it bounds another part of the volume. The check cannot
    // tell the parts apart, so it does not decide.
    expect(check(teeth, box({-5, -5, 1}, {1.3, 6, 4}), {0.9, 1.2}, from_source(side)), Verdict::not_checked,
           Verdict::holds);
}

// The nearer point lies in another tooth, as does the middle of the path to it, so it bounds another part.
TEST(VerifyPenetration, AnotherPartRefutesNothing) {
    const TriangleMesh teeth =
        joined(joined(box({0, 0, 0}, {1, 1, 4}), box({1.2, 0, 0}, {2.2, 1, 4})), box({2.4, 0, 0}, {3.4, 1, 4}));
    expect(check(teeth, box({-5, -5, 1}, {2.5, 6, 9}), {2.5, 4}, from_source({1, 0.5, 3.9})), Verdict::not_checked,
           Verdict::holds);
}

TEST(VerifyPenetration, ShapesStandWhereTheirPosesPutThem) {
    const Pose away{Eigen::Matrix3d::Identity(), {0.25, 0, 0}};
    expect(check(cube, bar, {0.25, 0.5}, from_target({0.75, 0.5, 0.5}), {}, away), Verdict::holds, Verdict::holds);
    expect(check(cube, bar, {0.27, 0.5}, from_target({0.75, 0.5, 0.5}), {}, away), Verdict::unsound, Verdict::holds,
           "bounded 0.25");
    expect(check(cube, bar, {0.7, 0.8}, from_target(end), away, {}), Verdict::holds, Verdict::holds);
    expect(check(cube, bar, {0, 0.1}, from_target(end), away, {}), Verdict::holds, Verdict::unsound, "lies deeper");
}

}  // namespace
}  // namespace hausbench
