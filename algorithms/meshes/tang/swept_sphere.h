// Swept sphere volumes, and a BVH with such a volume around each child. A swept sphere volume consists of all points
// within a given radius of a point, a segment or a rectangle. It fits a surface patch more tightly than a box does.
//
// After Larsen, Gottschalk, Lin, Manocha: Fast proximity queries with swept sphere volumes, 1999; used by Tang et al.
// 2009.
#pragma once

#include "algorithms/kernel/rounding.h"
#include "algorithms/structures/bvh.h"

#include <span>
#include <string_view>

namespace hausbench::tang {

using hausbench::distance_at_least, hausbench::distance_at_most;  // overloaded here

// All points within `radius` of the rectangle centre + s u + t v, where |s| <= 1 and |t| <= 1. u and v are orthogonal
// up to rounding. If v = 0, the rectangle is a segment; if also u = 0, it is a point.
struct SweptSphere {
    Vec3 centre = Vec3::Zero(), u = Vec3::Zero(), v = Vec3::Zero();
    double radius = 0;
};

// Returns a swept sphere that contains the points, and so their convex hull. Tries spheres, a segment and a rectangle
// along the principal axes of the points, and chooses the one with the least volume. The radius is rounded up, so
// rounding never leaves a point outside. O(n). Requires at least one point and coordinates up to 2^400.
SweptSphere swept_sphere_around(std::span<const Vec3> points);

// Return a lower and an upper bound on the distance from q to any point of the volume. Both are valid under rounding,
// as derived in swept_sphere.cpp.
double distance_at_least(const SweptSphere& volume, const Vec3& q);
double distance_at_most(const SweptSphere& volume, const Vec3& q);

// A TriangleBvh that also stores a swept sphere around the triangles of each child.
class SweptSphereBvh : public TriangleBvh {
public:
    static constexpr std::string_view structure_name = "swept sphere BVH";
    static constexpr int structure_layout = 1;

    // `mesh` must outlive this. O(n log n).
    explicit SweptSphereBvh(const TriangleMesh& mesh);

    // Returns the swept sphere around the triangles below a child of a node of tree().
    const SweptSphere& volume(std::size_t node, int child) const {
        return volumes_[node * tree_width + static_cast<std::size_t>(child)];
    }

    std::size_t bytes() const { return TriangleBvh::bytes() + volumes_.capacity() * sizeof(SweptSphere); }

private:
    void fill(std::size_t node, std::vector<Vec3>& below);

    std::vector<SweptSphere> volumes_;
};

}  // namespace hausbench::tang
