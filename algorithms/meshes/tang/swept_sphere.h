// Swept sphere volumes: all points within a radius of a point, a segment or a rectangle. They are tighter than boxes around surface
// patches. A BVH with one for each child.
//
// After Larsen, Gottschalk, Lin, Manocha: Fast proximity queries with swept sphere volumes, 1999; used by Tang et al. 2009.
#pragma once

#include "algorithms/structures/bvh.h"

#include <span>
#include <string_view>

namespace hausbench {

// Every point of the content is within `radius` of a point centre + s u + t v, |s| <= 1, |t| <= 1. u and v are orthogonal but
// for rounding; v = 0: a segment; u = v = 0: a point.
struct SweptSphere {
    Vec3 centre = Vec3::Zero(), u = Vec3::Zero(), v = Vec3::Zero();
    double radius = 0;
};

// Returns a volume around these points, and so around their convex hull: the smallest by volume of a sphere, a swept
// segment and a swept rectangle along the principal axes. The radius is rounded up. O(n). At least one point;
// coordinates up to 2^400.
SweptSphere swept_sphere_around(std::span<const Vec3> points);

// Lower and upper bounds of the distance from q to any point inside; valid under rounding (swept_sphere.cpp).
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
