// Volumes of two kinds of BVH, swept spheres (meshes/tang/swept_sphere.h) and boxes, with one interface for searches
// that take either.
#pragma once

#include "algorithms/meshes/tang/swept_sphere.h"

#include <array>
#include <cstddef>

namespace hausbench {

// A volume whose points are within `radius` of the convex hull of its corners: four for a swept sphere, eight for a
// box.
struct CornerVolume {
    std::array<Vec3, 8> corner;
    std::size_t count = 0;
    double radius = 0;

    Vec3 centre() const { return 0.5 * (corner[0] + corner[count - 1]); }  // these two are opposite
};

// Returns an upper bound of the distance from q to any point inside; valid under rounding.
double distance_at_most(const CornerVolume& volume, const Vec3& q);

// Return the volume of a child of a node of tree().
CornerVolume corners_of(const SweptSphereBvh& tree, std::size_t node, int child);
CornerVolume corners_of(const TriangleBvh& tree, std::size_t node, int child);

// Return a lower bound of the exact distance from q to any triangle below that child.
double distance_at_least(const SweptSphereBvh& tree, std::size_t node, int child, const Vec3& q);
double distance_at_least(const TriangleBvh& tree, std::size_t node, int child, const Vec3& q);

// Moves volumes that were built over the unposed shape.
class VolumePose {
public:
    explicit VolumePose(const Pose& pose);

    // Returns a volume that contains posed(p) (geometry.h) for every p inside. O(1).
    CornerVolume operator()(const CornerVolume& volume) const;

private:
    Pose pose_;
    bool identity_;
    double stretch_ = 1;  // upper bound of the factor by which a vector gets longer
    double rows_ = 1;     // the largest sum of absolute values in a row of the rotation
};

}  // namespace hausbench
