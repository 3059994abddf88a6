#include "algorithms/meshes/tang/swept_sphere.h"

#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>

namespace hausbench::tang {
namespace {

// In this file, u and v are the sides of the rectangle, so the unit roundoff 2^-53 is called eps.

// The *foot* of a point q is the point of the rectangle closest to q.
struct Foot {
    double squared;  // squared distance from q to the foot, as computed
    double size;     // at least |q - centre| + |u| + |v|, up to rounding; the error bounds below are multiples of it
};

// Returns the s in [-1, 1] for which s * axis is closest to r. Returns 0 if the axis is 0.
double along(const Vec3& r, const Vec3& axis) {
    const double length = squared_length(axis);
    return length > 0 ? std::clamp(dot(r, axis) / length, -1.0, 1.0) : 0.0;
}

double sum(const Vec3& x) { return std::abs(x[0]) + std::abs(x[1]) + std::abs(x[2]); }

// Computes the distance from q to its foot, the closest point of the rectangle. Treats u and v as exactly orthogonal,
// so that s and t can be computed independently of each other.
Foot foot_of(const SweptSphere& volume, const Vec3& q) {
    const Vec3 r = q - volume.centre;
    const Vec3 rest = (r - along(r, volume.u) * volume.u) - along(r, volume.v) * volume.v;
    return {squared_length(rest), sum(r) + sum(volume.u) + sum(volume.v)};
}

// Returns an upper bound, valid under rounding, on the largest distance from one of the points to the rectangle.
//
// In foot_of(), a difference, two products and two sums err by at most 8 eps size in each coordinate of `rest`, so by
// less than sqrt(3) * 8 eps size < 14 eps size in length, where size is Foot::size and eps = 2^-53. The computed length
// errs by 4 eps of itself, and it is at most 1.01 size. Together this is less than 20 eps size. next_up absorbs the
// rounding of the sum.
double farthest_foot(const SweptSphere& volume, std::span<const Vec3> points) {
    double most = 0;
    for (const Vec3& point : points) {
        const Foot foot = foot_of(volume, point);
        most =
            std::max(most, distance_at_most(foot.squared, true) +
                               WATCHED("swept_sphere_around: the rounding of a foot", 20 * unit_roundoff * foot.size));
    }
    return next_up(most);
}

// Returns the principal axes of the points, the axis of the largest moment first. Computes with (point - middle) /
// extent so that no moment overflows or underflows.
std::array<Vec3, 3> principal_axes(std::span<const Vec3> points, const Vec3& middle, double extent) {
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    Vec3 mean = Vec3::Zero();
    for (const Vec3& point : points) mean += (point - middle) / extent;
    mean /= static_cast<double>(points.size());
    for (const Vec3& point : points) {
        const Vec3 r = (point - middle) / extent - mean;
        moments += r * r.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments);
    return {solver.eigenvectors().col(2), solver.eigenvectors().col(1), solver.eigenvectors().col(0)};
}

// Returns the bounding box of the points in the coordinate system with these axes and its origin at `middle`.
Box box_along(const std::array<Vec3, 3>& axes, std::span<const Vec3> points, const Vec3& middle) {
    Box box;
    for (const Vec3& point : points) {
        const Vec3 r = point - middle;
        box.add(Vec3(dot(r, axes[0]), dot(r, axes[1]), dot(r, axes[2])));
    }
    return box;
}

double volume_of(const SweptSphere& s) {
    constexpr double pi = 3.14159265;
    const double a = 2 * std::sqrt(squared_length(s.u)), b = 2 * std::sqrt(squared_length(s.v)), r = s.radius;
    return (4.0 / 3) * pi * r * r * r + pi * r * r * (a + b) + 2 * a * b * r;
}

}  // namespace

SweptSphere swept_sphere_around(std::span<const Vec3> points) {
    Box box;
    for (const Vec3& point : points) box.add(point);
    const Vec3 middle = 0.5 * box.low + 0.5 * box.high;
    const double extent = (box.high - box.low).maxCoeff();
    SweptSphere best;
    best.centre = middle;
    best.radius = farthest_foot(best, points);
    if (!(extent > 0x1p-300) || points.size() < 2) return best;

    const std::array<Vec3, 3> axes = principal_axes(points, middle, extent);
    const Box along_axes = box_along(axes, points, middle);
    const Vec3 half = 0.5 * (along_axes.high - along_axes.low), centre = 0.5 * (along_axes.low + along_axes.high);
    SweptSphere swept;
    swept.centre = middle + centre[0] * axes[0] + centre[1] * axes[1] + centre[2] * axes[2];
    const auto offer = [&](double u, double v) {
        swept.u = std::max(u, 0.0) * axes[0];
        swept.v = std::max(v, 0.0) * axes[1];
        swept.radius = farthest_foot(swept, points);
        if (volume_of(swept) < volume_of(best)) best = swept;
    };
    // Try a sphere, a segment and a rectangle. The radius will be about half the width of the points in the first
    // direction left out, and extends each end of a side by as much. So shorten the sides by this half width.
    offer(0, 0);
    offer(half[0] - half[1], 0);
    offer(half[0] - half[2], half[1] - half[2]);
    return best;
}

// foot_of() finds the foot as if u and v were orthogonal. Let r = q - centre. Then
//     |r - s u - t v|^2 = f(s) + g(t) + 2 s t u.v + |r|^2, with f(s) = s^2 |u|^2 - 2 s r.u, and g likewise for t and v.
// The foot minimises f + g up to rounding, and |2 s t u.v| <= 2 |u.v| at the foot and at the closest point. So the
// least squared distance is at least the squared distance at the foot minus 4 |u.v|.
//
// Rounding: s may be off by 8 eps size / |u|, which changes f by less than 64 eps^2 size^2 near its minimum; t
// likewise. `rest` is off by 14 eps size in length, so its squared length by 40 eps size^2. 4 |u.v| is off by less than
// 4 eps size^2, because |u| |v| <= size^2 / 4. Together this is less than 64 eps size^2. The code subtracts 100 eps
// size^2, which leaves room for the rounding of the subtractions and of `size`.
//
// Underflow: each product may be off by 2^-1075. If |u| >= 2^-505, this changes s by less than 2^-62, which is less
// than the rounding error above. If |u| < 2^-505, a wrong s moves the foot by at most 2^-504. The same holds for v and
// t. The squared length and 4 |u.v| are off by 2^-1070, and so the root by at most 2^-535, because sqrt(x + y) <=
// sqrt(x) + sqrt(y). Together this is less than 2^-502 in length. distance_at_least (rounding.h) subtracts 2^-500,
// which is more.
double distance_at_least(const SweptSphere& volume, const Vec3& q) {
    const Foot foot = foot_of(volume, q);
    const double squared =
        foot.squared -
        WATCHED("swept sphere, lower bound: u and v that are not orthogonal", 4 * std::abs(dot(volume.u, volume.v))) -
        WATCHED("swept sphere, lower bound: the rounding of the foot", 100 * unit_roundoff * (foot.size * foot.size));
    if (!(squared > 0)) return 0;
    return std::max(0.0, next_down(distance_at_least(squared, WATCHED("swept sphere, lower bound: underflow", true)) -
                                   WATCHED("swept sphere, lower bound: the radius", volume.radius)));
}

// The distance from q to a point of the rectangle is largest at a corner. Call this distance D, its computed value f,
// and let r = q - centre.
//
// Rounding: the code takes three differences: r, r - s u, and (r - s u) - t v, where s and t are 1 or -1. Each errs by
// eps times its length, and none is longer than D. For r, this holds because the mean of the four squared distances to
// the corners is |r|^2 + |u|^2 + |v|^2. For r - s u with the s of the farthest corner, it holds because the mean over
// the two corners with this s is |r - s u|^2 + |v|^2. So the differences err by at most 3 eps D together. A square, two
// sums and the root add 2.5 eps D. So D <= f (1 + 5.5 eps), up to terms of order eps^2.
//
// Rounding up covers this. distance_at_most (rounding.h) computes f (1 + 4 eps), which loses at most half an ulp, and
// raises it by one ulp twice. As an ulp exceeds eps f, the result is at least f (1 + 5.5 eps). The sum with the radius
// is rounded by up to half an ulp and then raised by one ulp, which leaves half an ulp to spare. Underflow: as in
// distance_at_most.
double distance_at_most(const SweptSphere& volume, const Vec3& q) {
    const Vec3 r = q - volume.centre;
    double most = 0;
    for (const double s : {-1.0, 1.0}) {
        for (const double t : {-1.0, 1.0}) most = std::max(most, squared_length((r - s * volume.u) - t * volume.v));
    }
    return WATCHED_ELSE(
        "swept sphere, upper bound: rounding up",
        next_up(distance_at_most(most, true) + WATCHED("swept sphere, upper bound: the radius", volume.radius)),
        std::sqrt(most) + volume.radius);
}

SweptSphereBvh::SweptSphereBvh(const TriangleMesh& mesh)
    : TriangleBvh(mesh), volumes_(tree().nodes.size() * tree_width) {
    std::vector<Vec3> below;
    fill(0, below);
}

// Computes the swept spheres of the children of a node, recursively. Appends the corners of all triangles below the
// node to `below`.
void SweptSphereBvh::fill(std::size_t node, std::vector<Vec3>& below) {
    const WideNode& wide = tree().nodes[node];
    for (int c = 0; c < wide.count; ++c) {
        const std::size_t begin = below.size();
        if (wide.child[c] >= 0) {
            fill(static_cast<std::size_t>(wide.child[c]), below);
        } else {
            for (const Index triangle : tree().leaf(static_cast<std::size_t>(~wide.child[c]))) {
                const Triangle t = triangle_of(mesh(), triangle);
                below.insert(below.end(), {t.a, t.b, t.c});
            }
        }
        volumes_[node * tree_width + static_cast<std::size_t>(c)] =
            swept_sphere_around(std::span(below).subspan(begin));
    }
}

}  // namespace hausbench::tang
