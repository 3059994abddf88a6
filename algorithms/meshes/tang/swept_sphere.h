// Swept sphere volumes: all points within a radius of a point, a segment or a rectangle. They fit surface patches
// more tightly than boxes do. Also a BVH with one such volume per child.
//
// After Larsen, Gottschalk, Lin, Manocha: Fast proximity queries with swept sphere volumes, 1999; used by Tang et al.
// 2009.
#pragma once

#include "algorithms/structures/bvh.h"

#include <span>
#include <string_view>

namespace hausbench {

// Every point of the content is within `radius` of some point centre + s u + t v, |s| <= 1, |t| <= 1. u and v are
// orthogonal up to rounding. If v = 0 this is a segment, if also u = 0 a point.
struct SweptSphere {
    Vec3 centre = Vec3::Zero(), u = Vec3::Zero(), v = Vec3::Zero();
    double radius = 0;
};

// Returns a volume that contains the points, and so their convex hull: a sphere, or a segment or a rectangle along
// the principal axes with its radius, whichever has the least volume. The radius is rounded up. O(n). Requires at
// least one point and coordinates up to 2^400.
SweptSphere swept_sphere_around(std::span<const Vec3> points);

// Return a lower and an upper bound of the distance from q to any point inside; valid under rounding
// (swept_sphere.cpp).
double distance_at_least(const SweptSphere& volume, const Vec3& q);
double distance_at_most(const SweptSphere& volume, const Vec3& q);

class SweptSphereBvh : public TriangleBvh {
public:
    static constexpr std::string_view structure_name = "swept sphere BVH";
    static constexpr int structure_layout = 1;

    // `mesh` must outlive this. O(n log n).
    explicit SweptSphereBvh(const TriangleMesh& mesh);

    // Returns the volume around the triangles below a child of a node of tree().
    const SweptSphere& volume(std::size_t node, int child) const {
        return volumes_[node * tree_width + static_cast<std::size_t>(child)];
    }

    std::size_t bytes() const { return TriangleBvh::bytes() + volumes_.capacity() * sizeof(SweptSphere); }

private:
    void fill(std::size_t node, std::vector<Vec3>& below);

    std::vector<SweptSphere> volumes_;
};

}  // namespace hausbench
