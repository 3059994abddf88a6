// One interface to the bounding volumes of two kinds of BVH, so that a search template works with either: swept spheres
// (SweptSphereBvh in swept_sphere.h) and boxes (TriangleBvh).
#pragma once

#include "algorithms/meshes/tang/swept_sphere.h"

#include <array>
#include <cstddef>

namespace hausbench::tang {

using hausbench::distance_at_least, hausbench::distance_at_most;  // overloaded here

// A volume of either kind: all points within `radius` of the convex hull of its corners. A swept sphere has four
// corners, a box eight.
struct CornerVolume {
    std::array<Vec3, 8> corner;
    std::size_t count = 0;
    double radius = 0;

    Vec3 centre() const { return 0.5 * (corner[0] + corner[count - 1]); }  // these two corners are opposite
};

// Returns an upper bound on the distance from q to any point of the volume; valid under rounding.
double distance_at_most(const CornerVolume& volume, const Vec3& q);

// Return the bounding volume of a child of a node, before the pose of the shape is applied.
CornerVolume corners_of(const SweptSphereBvh& tree, std::size_t node, int child);
CornerVolume corners_of(const TriangleBvh& tree, std::size_t node, int child);

// Return a lower bound on the exact distance from q to any triangle below a child of a node, before the pose is
// applied.
double distance_at_least(const SweptSphereBvh& tree, std::size_t node, int child, const Vec3& q);
double distance_at_least(const TriangleBvh& tree, std::size_t node, int child, const Vec3& q);

// Moves bounding volumes by the pose of a shape. A tree stores them for the shape before its motion.
class VolumePose {
public:
    explicit VolumePose(const Pose& pose);

    // Returns a volume that contains the moved, rounded point posed(p) (kernel/geometry.h) for every p in `volume`.
    // O(1).
    CornerVolume operator()(const CornerVolume& volume) const;

private:
    Pose pose_;
    bool identity_;
    double stretch_ = 1;  // upper bound on |R x| / |x|, where R is pose_.rotation
    double rows_ = 1;     // the largest sum of absolute values in a row of R
};

}  // namespace hausbench::tang
