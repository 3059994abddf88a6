// Penetration depths against closed forms, with every solver that can measure them; and refused inputs.
#include "algorithms/error.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/solids.h"

#include <cmath>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

constexpr double tolerance = 1e-6, slack = 1e-9;  // slack: cut points are rounded

Query query_of() {
    Query query;
    query.quantity = Quantity::penetration;
    query.tolerance = {Tolerance::Of::absolute, tolerance};
    return query;
}

Result depth(const TriangleMesh& a, const TriangleMesh& b, const ParameterMap& given = {}, Query query = query_of()) {
    const SolverEntry& entry = find_solver("penetration");
    QuerySet queries;
    queries.moves = queries.target_moves = true;
    const Session session(entry, Options("penetration", entry.info.parameters, given), {a, b}, queries);
    Trace untraced;
    return session.solve(query, untraced);
}

void expect_depth(const Result& result, double exact, double wider = slack) {
    EXPECT_EQ(result.status, Status::converged) << result.note;
    EXPECT_LE(result.bounds.lower, exact + wider);
    EXPECT_GE(result.bounds.upper, exact - wider);
    EXPECT_LE(result.bounds.gap(), tolerance);
}

double reported(const Result& result, const std::string& name) { return std::get<double>(result.reported.at(name)); }

// A bar sticks 0.5 into a cube: its end is 0.5 from the cube's face, and the middle of that face
// is 0.3 from the bar's sides.
const TriangleMesh cube = box({0, 0, 0}, {1, 1, 1}), bar = box({0.5, 0.2, 0.2}, {2, 0.8, 0.8});

TEST(Penetration, BoxesBySolver) {
    for (const char* solver : {"cover", "tang", "guthe", "kang", "zheng", "sacht"}) {
        SCOPED_TRACE(solver);
        const Result result = depth(cube, bar, {{"solver", std::string(solver)}});
        expect_depth(result, 0.5);
        EXPECT_EQ(reported(result, "parts"), 1);
        expect_depth(depth(bar, cube, {{"solver", std::string(solver)}}), 0.5);
        expect_depth(depth(cube, box({0.9, 0.2, 0.2}, {2, 0.8, 0.8}), {{"solver", std::string(solver)}}), 0.1);
    }
}

TEST(Penetration, TheWitnessIsTheDeepestPair) {
    const Result result = depth(cube, bar);
    EXPECT_EQ(result.witness.direction, Witness::Direction::target_to_source);
    EXPECT_NEAR(result.witness.target_point[0], 0.5, slack);
    EXPECT_NEAR(result.witness.source_point[0], 1, slack);
    EXPECT_NEAR((result.witness.source_point - result.witness.target_point).norm(), 0.5, slack);
}

// Faces shared by both solids count for both: the middle of the face x = 1 is 0.5 from them, less than 0.8 from the
// opposite face.
TEST(Penetration, SidesInOnePlaneAreOfBoth) {
    expect_depth(depth(cube, box({0.2, 0, 0}, {2, 1, 1})), 0.5);
    expect_depth(depth(box({0.2, 0, 0}, {2, 1, 1}), cube), 0.5);
    expect_depth(depth(cube, box({0.9, 0, 0}, {2, 1, 1})), 0.1);
    expect_depth(depth(cube, cube), 0);
}

TEST(Penetration, Nested) {
    const TriangleMesh inner = box({-1, -1, -1}, {1, 1, 1}), outer = box({-3, -3, -3}, {3, 3, 3});
    expect_depth(depth(inner, outer), 2);
    expect_depth(depth(outer, inner), 2);
    EXPECT_EQ(depth(inner, outer).witness.direction, Witness::Direction::source_to_target);
    const Result turned = depth(outer, inner);
    EXPECT_EQ(turned.witness.direction, Witness::Direction::target_to_source);
    EXPECT_LE(turned.witness.target_point.cwiseAbs().maxCoeff(), 1);  // a point of B, the inner box
    EXPECT_NEAR(turned.witness.source_point.cwiseAbs().maxCoeff(), 3, slack);
}

TEST(Penetration, NestedMoves) {
    const TriangleMesh inner = box({-1, -1, -1}, {1, 1, 1}), outer = box({-3, -3, -3}, {3, 3, 3});
    Query query = query_of();
    query.source_pose.translation = {10, 0, 0};
    query.target_pose.translation = {10.5, 0, 0};  // the middle of one face of the inner box is 2.5 from the outer box
    expect_depth(depth(inner, outer, {}, query), 2.5);
    query.target_pose.rotation *= 2;
    expect_depth(depth(inner, outer, {}, query), 5.5);
    expect_depth(depth(outer, inner, {}, query), 1.5);
}

// The surface of a box lies inside the wall of a hollow box, so the overlap is a shell: one part with two surfaces. Its
// outer corners are farthest from the cavity.
TEST(Penetration, Hollow) {
    const TriangleMesh shell = joined(box({-3, -3, -3}, {3, 3, 3}), inside_out(box({-2, -2, -2}, {2, 2, 2})));
    const Result result = depth(box({-2.5, -2.5, -2.5}, {2.5, 2.5, 2.5}), shell);
    EXPECT_EQ(reported(result, "parts"), 1);
    expect_depth(result, 0.5 * std::sqrt(3.0));
    expect_depth(depth(box({-1, -1, -1}, {1, 1, 1}), shell), 0);  // in the cavity
}

TEST(Penetration, TouchingIsNoDepth) {
    expect_depth(depth(cube, box({1, 0, 0}, {2, 1, 1})), 0);
    expect_depth(depth(cube, box({1, 0.2, 0.3}, {2, 0.7, 2})), 0);
    expect_depth(depth(cube, box({1, 1, 0}, {2, 2, 1})), 0);
    expect_depth(depth(cube, box({1, 1, 1}, {2, 2, 2})), 0);
    expect_depth(depth(cube, box({5, 5, 5}, {6, 6, 6})), 0);
}

TEST(Penetration, TheDeepestOfSeveralParts) {
    const TriangleMesh teeth =
        joined(joined(box({0, 0, 0}, {1, 1, 1.1}), box({2, 0, 0}, {3, 1, 1.3})), box({4, 0, 0}, {5, 1, 1.2}));
    const TriangleMesh slab = box({-5, -5, 1}, {9, 6, 4});
    for (const bool each : {false, true}) {
        const Result result = depth(teeth, slab, {{"each_part", each}});
        expect_depth(result, 0.3);
        EXPECT_EQ(reported(result, "parts"), 3);
        EXPECT_NEAR(result.witness.source_point[2], 1.3, slack);
        EXPECT_EQ(result.reported.contains("length: part 3, upper"), each);
    }
    const Result all = depth(teeth, slab, {{"each_part", true}});
    std::vector<double> depths;
    for (const char* part : {"length: part 1", "length: part 2", "length: part 3"}) {
        const double lower = reported(all, std::string(part) + ", lower"),
                     upper = reported(all, std::string(part) + ", upper");
        EXPECT_LE(upper - lower, tolerance);
        depths.push_back(upper);
    }
    std::sort(depths.begin(), depths.end());
    EXPECT_NEAR(depths[0], 0.1, 2 * tolerance);
    EXPECT_NEAR(depths[1], 0.2, 2 * tolerance);
    EXPECT_NEAR(depths[2], 0.3, 2 * tolerance);
}

// The overlap has two parts: the one with the larger bounding box is measured first but is not the deepest.
TEST(Penetration, ASmallerPartMayBeDeeper) {
    const TriangleMesh teeth = joined(box({0, 0, 0}, {3, 3, 1.1}), box({5, 0, 0}, {6, 1, 1.3}));
    const TriangleMesh slab = box({-5, -5, 1}, {9, 6, 4});
    for (const bool each : {false, true}) expect_depth(depth(teeth, slab, {{"each_part", each}}), 0.3);
}

TEST(Penetration, ThreadsChangeNothing) {
    const TriangleMesh ball = sphere(4);
    Query query = query_of();
    query.target_pose.translation = {1.2, 0.3, 0.1};
    const Result single = depth(ball, ball, {}, query);
    query.threads = 2;
    const Result several = depth(ball, ball, {}, query);
    EXPECT_GT(single.bounds.lower, 0.5);
    EXPECT_EQ(single.bounds.lower, several.bounds.lower);
    EXPECT_EQ(single.bounds.upper, several.bounds.upper);
    EXPECT_EQ(single.witness.source_point, several.witness.source_point);
}

// Two equally deep parts give the second query a floor at or above the cutoff. The tolerance must still end that query.
TEST(Penetration, ACutoffAtTheDepthOfAPart) {
    const TriangleMesh teeth = joined(box({0, 0, 0}, {1, 1, 1.25}), box({2, 0, 0}, {3, 1, 1.25}));
    const TriangleMesh slab = box({-5, -5, 1}, {9, 6, 4});
    for (const double cutoff : {0.2, 0.25, 0.3}) {
        Query query = query_of();
        query.cutoff = cutoff;
        const Result result = depth(teeth, slab, {}, query);
        EXPECT_EQ(result.status, cutoff < 0.25 ? Status::above_cutoff : Status::converged) << cutoff;
        EXPECT_LE(result.bounds.lower, 0.25 + slack);
        EXPECT_GE(result.bounds.upper, 0.25 - slack);
    }
}

// Unit spheres 1.6 apart overlap by 0.4 between their poles, which are vertices. Each mesh lies inside its sphere by at
// most `sagitta`.
TEST(Penetration, Spheres) {
    const TriangleMesh ball = sphere(4);
    Query query = query_of();
    query.target_pose.translation = {1.6, 0, 0};
    const double sagitta = sphere_flatness(ball);
    for (const char* solver : {"cover", "tang"}) {
        const Result result = depth(ball, ball, {{"solver", std::string(solver)}}, query);
        expect_depth(result, 0.4, 2 * sagitta);
        EXPECT_GT(0.05, 2 * sagitta);
    }
}

TEST(Penetration, MovedTogetherOrAloneItIsTheSame) {
    Query query = query_of();
    query.source_pose =
        query.target_pose = {Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix(), {4, -5, 6}};
    expect_depth(depth(cube, bar, {}, query), 0.5);
    query.source_pose = {};
    query.target_pose = {Eigen::Matrix3d::Identity(), {0.25, 0, 0}};
    expect_depth(depth(cube, bar, {}, query), 0.25);
    query.source_pose = {Eigen::Matrix3d::Identity(), {0.25, 0, 0}};
    query.target_pose = {};
    expect_depth(depth(cube, bar, {}, query), 0.75);
}

TEST(Penetration, FacesThatPointInwardAndMirrors) {
    expect_depth(depth(inside_out(cube), bar), 0.5);
    expect_depth(depth(cube, inside_out(bar)), 0.5);
    Query query = query_of();
    query.source_pose.rotation = query.target_pose.rotation = Vec3(-1, 1, 1).asDiagonal();
    expect_depth(depth(cube, bar, {}, query), 0.5);
}

TEST(Penetration, AnyScale) {
    for (const double scale : {1e-100, 1e-9, 1e12, 1e100}) {
        Query query = query_of();
        query.tolerance.value *= scale;
        const Result result = depth(scaled(cube, scale), scaled(bar, scale), {}, query);
        EXPECT_EQ(result.status, Status::converged);
        EXPECT_NEAR(result.bounds.lower / scale, 0.5, 2 * tolerance);
        EXPECT_NEAR(result.bounds.upper / scale, 0.5, 2 * tolerance);
    }
}

TEST(Penetration, WhatBoundsNoVolumeIsRefusedWhereItOverlaps) {
    TriangleMesh open = cube;
    open.triangles.conservativeResize(open.triangles.rows() - 1, 3);
    const auto expect_refused = [](const Result& result, const std::string& why) {
        EXPECT_EQ(result.status, Status::stalled);
        EXPECT_EQ(result.bounds.lower, 0);
        EXPECT_TRUE(std::isinf(result.bounds.upper));
        EXPECT_NE(result.note.find(why), std::string::npos) << result.note;
    };
    expect_refused(depth(open, bar), "A bounds no volume");
    expect_refused(depth(open, bar), "not closed: 3 edges");
    expect_refused(depth(bar, open), "B bounds no volume");
    expect_refused(depth(joined(cube, box({0.5, 0.5, 0.5}, {3, 3, 3})), bar),
                   "crosses itself or has triangles without area");
    TriangleMesh fin = cube;  // three triangles share an edge
    fin.vertices.conservativeResize(9, 3);
    fin.vertices.row(8) << 5, 5, 5;
    fin.triangles.conservativeResize(13, 3);
    fin.triangles.row(12) << fin.triangles(0, 0), fin.triangles(0, 1), 8;
    expect_refused(depth(fin, bar), "A bounds no volume");
    TriangleMesh flat = cube;
    flat.triangles.setZero();
    expect_refused(depth(flat, bar), "all its triangles are points");
    expect_depth(depth(open, box({5, 5, 5}, {6, 6, 6})), 0);
}

TEST(Penetration, FloorCutoffAndStages) {
    Query query = query_of();
    query.floor = query.cutoff = 0.4;
    EXPECT_EQ(depth(cube, bar, {}, query).status, Status::above_cutoff);
    query.floor = query.cutoff = 0.6;
    EXPECT_EQ(depth(cube, bar, {}, query).status, Status::below_floor);
    query = query_of();
    query.wanted.stages = true;
    const Result result = depth(cube, bar, {}, query);
    EXPECT_GT(reported(result, "seconds: cut"), 0);
    EXPECT_GT(reported(result, "seconds: measure"), 0);
    EXPECT_FALSE(depth(cube, bar).reported.contains("seconds: cut"));
}

TEST(Penetration, QuantitiesThatASolverDoesNotOffer) {
    EXPECT_THROW((void)depth(cube, bar, {}, Query{}), InputError);
    const SolverEntry& cover = find_solver("cover");
    const Session session(cover, Options("cover", cover.info.parameters, {}), {cube, bar}, {});
    Trace untraced;
    EXPECT_THROW((void)session.solve(query_of(), untraced), InputError);
    EXPECT_NE(refusal(cover.info, ShapeKind::mesh, ShapeKind::mesh, Quantity::penetration).find("'penetration' does"),
              std::string::npos);
    EXPECT_NE(refusal(find_solver("penetration").info, ShapeKind::mesh, ShapeKind::mesh).find("not h(A,B)"),
              std::string::npos);
    EXPECT_NE(refusal(find_solver("penetration").info, ShapeKind::points, ShapeKind::mesh, Quantity::penetration)
                  .find("takes no"),
              std::string::npos);
}

}  // namespace
}  // namespace hausbench
