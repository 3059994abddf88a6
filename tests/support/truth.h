// The exact answer of a scene, and the checks that every result must pass against it. Shapes are moved by their poses
// beforehand.
#pragma once

#include "algorithms/kernel/rounding.h"
#include "algorithms/solver.h"
#include "tests/support/reference.h"

#include <gtest/gtest.h>

namespace hausbench {

using Real = long double;

inline Scene posed(const Scene& scene, const Pose& source, const Pose& target = {}) {
    const auto moved = [](const Shape& shape, const Pose& pose) {
        Shape copy = shape;
        points_of(copy) = posed(points_of(copy), pose);
        return copy;
    };
    return {moved(scene.source, source), moved(scene.target, target)};
}

struct Truth {
    Scene posed;
    bool points;              // both shapes are point sets, so `squared` is exact
    Real low = 0, high = 0;   // interval of the distance; unused for point sets
    exact::Rational squared;  // squared distance of point sets; for meshes only of the farthest vertex, a lower bound
    double magnitude;         // largest |coordinate|
    double tolerance;         // a millionth of the extent
};

inline exact::Rational exact_squared_distance(const Vec3& point, const TriangleMesh& mesh) {
    const auto corner = [&](Index i, int k) { return exact::vector(mesh.vertices.row(mesh.triangles(i, k))); };
    const exact::RVec3 p = exact::vector(point);
    exact::Rational least = exact::squared_distance(p, corner(0, 0));
    for (Index i = 0; i < mesh.triangles.rows(); ++i) {
        least = std::min(least, exact::squared_distance_to_triangle(p, corner(i, 0), corner(i, 1), corner(i, 2)));
    }
    return least;
}

// Returns h(A,B) of a scene at rest: exact for point sets, for meshes an interval of width `gap` times the extent.
inline Truth truth_of(const Scene& scene, Real gap = 1e-7L) {
    Truth truth{scene, kind_of(scene.source) == ShapeKind::points, 0, 0, 0, 0, 0};
    const Points &source = points_of(scene.source), &target = points_of(scene.target);
    truth.magnitude = std::max(magnitude(source), magnitude(target));
    Real extent = 0;
    for (int k = 0; k < 3; ++k) {
        const Real high = std::max(source.col(k).maxCoeff(), target.col(k).maxCoeff());
        extent = std::max(extent, high - std::min(source.col(k).minCoeff(), target.col(k).minCoeff()));
    }
    truth.tolerance = extent > 0 ? static_cast<double>(1e-6L * extent) : 1e-6;
    if (truth.points) {
        truth.squared = exact_squared_hausdorff(source, target);
        return truth;
    }
    const TriangleMesh& mesh = mesh_of(scene.target);
    const MeshReference reference(mesh);
    std::tie(truth.low, truth.high) = reference.hausdorff(source, mesh_of(scene.source).triangles, gap * extent);
    for (Index v = 0; v < source.rows(); ++v)
        truth.squared = std::max(truth.squared, exact_squared_distance(source.row(v), mesh));
    const Real error = 0x1p-58L * truth.magnitude;  // rounding in the reference itself
    truth.low -= error;
    truth.high += error;
    return truth;
}

// Returns H(A,B) of a scene at rest.
inline Truth symmetric_truth_of(const Scene& scene, Real gap = 1e-7L) {
    Truth truth = truth_of(scene, gap);
    const Truth other = truth_of({scene.target, scene.source}, gap);
    truth.low = std::max(truth.low, other.low);
    truth.high = std::max(truth.high, other.high);
    truth.squared = std::max(truth.squared, other.squared);
    return truth;
}

inline bool encloses(const Bounds& bounds, const Truth& truth, double slack) {
    if (!truth.points) return bounds.lower - slack <= truth.high && bounds.upper + slack >= truth.low;
    const exact::Rational low = bounds.lower;
    const bool below = low * low <= truth.squared;
    if (std::isinf(bounds.upper)) return below;
    const exact::Rational high = bounds.upper;
    return below && high * high >= truth.squared;
}

// Checks bounds against the truth. A solver that is not certified may be off by 1e-10 of the largest coordinate.
inline void check_bounds(const SolverInfo& info, const Truth& truth, const Bounds& bounds, const std::string& where) {
    EXPECT_GE(bounds.lower, 0) << where;
    EXPECT_LE(bounds.lower, bounds.upper) << where;
    if (info.certified && std::isfinite(bounds.upper)) {  // to the last bit if a vertex attains the distance
        const exact::Rational high = bounds.upper;
        EXPECT_TRUE(high * high >= truth.squared) << where << ": upper " << bounds.upper;
    }
    EXPECT_TRUE(encloses(bounds, truth, info.certified ? 0 : 1e-10 * truth.magnitude))
        << where << ": [" << bounds.lower << ", " << bounds.upper << "] against [" << truth.low << ", " << truth.high
        << "]";
}

namespace check {

// A witness: its far point on `source`, and its near point on `target`.
struct Pair {
    Vec3 far, near;
    Index far_element, near_element;
};

inline void points(const Points& source, const Points& target, const Pair& w, double lower, const std::string& where) {
    EXPECT_EQ(w.far, Vec3(source.row(w.far_element))) << where;
    EXPECT_EQ(w.near, Vec3(target.row(w.near_element))) << where;
    Points alone(1, 3);
    alone.row(0) = w.far;
    const exact::Rational low = lower, nearest = exact_squared_hausdorff(alone, target);
    EXPECT_TRUE(nearest >= low * low) << where;
    EXPECT_TRUE(exact::squared_distance(exact::vector(w.far), exact::vector(w.near)) == nearest) << where;
}

inline void meshes(const TriangleMesh& source, const TriangleMesh& target, const Pair& w, double lower,
                   const std::string& where) {
    const Real slack = 1e-13L * std::max(magnitude(source.vertices), magnitude(target.vertices));
    const auto triangle_of = [](const TriangleMesh& mesh, Index i) {
        return MeshReference(TriangleMesh{mesh.vertices, mesh.triangles.row(i)});
    };
    const auto far = MeshReference::vector(w.far), near = MeshReference::vector(w.near);
    EXPECT_LE(triangle_of(source, w.far_element).distance(far), slack) << where;
    EXPECT_LE(triangle_of(target, w.near_element).distance(near), slack) << where;
    for (Index v = 0; v < source.vertices.rows(); ++v) {
        if (Vec3(source.vertices.row(v)) != w.far) continue;
        const exact::Rational low = lower;  // to the last bit, because the point is exactly on the shape
        EXPECT_TRUE(low * low <= exact_squared_distance(w.far, target)) << where;
        break;
    }
    const Real nearest = MeshReference(target).distance(far);
    EXPECT_GE(nearest, lower - slack) << where;
    Real squared = 0;
    for (std::size_t k = 0; k < 3; ++k) squared += (far[k] - near[k]) * (far[k] - near[k]);
    EXPECT_LE(std::abs(std::sqrt(squared) - nearest), slack) << where;
}

}  // namespace check

// Checks a witness, for shapes at rest: its far point must lie on the shape that its direction names, at least the
// lower bound away from the other shape, and its near point must be the nearest one there.
inline void check_witness(const Scene& scene, const Result& result, const std::string& where) {
    const Witness& w = result.witness;
    if (w.source_element < 0) {  // no witness: points that were never computed must not look like one
        EXPECT_FALSE(w.source_point.allFinite() || w.target_point.allFinite()) << where;
        return;
    }
    ASSERT_LT(w.source_element, element_count(scene.source)) << where;
    ASSERT_GE(w.target_element, 0) << where;
    ASSERT_LT(w.target_element, element_count(scene.target)) << where;
    const bool forward = w.direction == Witness::Direction::source_to_target;
    const Shape &far = forward ? scene.source : scene.target, &near = forward ? scene.target : scene.source;
    check::Pair pair{w.source_point, w.target_point, w.source_element, w.target_element};
    if (!forward) std::swap(pair.far, pair.near), std::swap(pair.far_element, pair.near_element);
    if (kind_of(far) == ShapeKind::points)
        check::points(points_of(far), points_of(near), pair, result.bounds.lower, where);
    else
        check::meshes(mesh_of(far), mesh_of(near), pair, result.bounds.lower, where);
}

inline bool same_bits(const Vec3& a, const Vec3& b) {
    return a == b || (a.array().isNaN().all() && b.array().isNaN().all());
}

inline void expect_same_answer(const Result& a, const Result& b, const std::string& where) {
    EXPECT_EQ(a.status, b.status) << where;
    EXPECT_EQ(a.bounds.lower, b.bounds.lower) << where;
    EXPECT_EQ(a.bounds.upper, b.bounds.upper) << where;
    EXPECT_TRUE(same_bits(a.witness.source_point, b.witness.source_point)) << where;
    EXPECT_TRUE(same_bits(a.witness.target_point, b.witness.target_point)) << where;
    EXPECT_EQ(a.witness.source_element, b.witness.source_element) << where;
    EXPECT_EQ(a.witness.target_element, b.witness.target_element) << where;
    EXPECT_EQ(a.witness.direction, b.witness.direction) << where;
    EXPECT_EQ(a.reported, b.reported) << where;
}

}  // namespace hausbench
