// The volumes of two kinds of BVH, for searches that take either: swept spheres (meshes/tang/swept_sphere.h) and boxes.
#pragma once

#include "algorithms/meshes/tang/swept_sphere.h"

#include <array>
#include <cstddef>

namespace hausbench {

// Everything inside is within `radius` of the convex hull of the corners: four of a swept sphere, eight of a box.
struct CornerVolume {
    std::array<Vec3, 8> corner;
    std::size_t count = 0;
    double radius = 0;

    Vec3 centre() const { return 0.5 * (corner[0] + corner[count - 1]); }  // these two are opposite
};

// A bound of the distance between q and any point inside, proven under rounding. None is farther.
double distance_at_most(const CornerVolume& volume, const Vec3& q);

// Around the child of a node of tree().
CornerVolume corners_of(const SweptSphereBvh& tree, std::size_t node, int child);
CornerVolume corners_of(const TriangleBvh& tree, std::size_t node, int child);

// None of the triangles below that child is nearer to q, in exact arithmetic.
double distance_at_least(const SweptSphereBvh& tree, std::size_t node, int child, const Vec3& q);
double distance_at_least(const TriangleBvh& tree, std::size_t node, int child, const Vec3& q);

// A pose of volumes that were built over the shape where it stands.
class VolumePose {
public:
    explicit VolumePose(const Pose& pose);

    // Around posed(p) (geometry.h) for every p inside. O(1).
    CornerVolume operator()(const CornerVolume& volume) const;

private:
    Pose pose_;
    bool identity_;
    double stretch_ = 1;  // no vector gets longer by more than this factor
    double rows_ = 1;     // the largest sum of a row of the rotation's absolute values
};

}  // namespace hausbench
