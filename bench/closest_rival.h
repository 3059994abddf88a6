// Programs that answer closest point queries over the triangles of a mesh, timed against each other by compare.cpp.
#pragma once

#include "algorithms/scene.h"

#include <memory>
#include <string>
#include <vector>

namespace hausbench {

class ClosestRival {
public:
    virtual ~ClosestRival() = default;

    virtual std::string name() const = 0;

    // Whatever form the mesh must have beforehand (Embree: single precision). Not timed. `mesh` must outlive this.
    virtual void take(const TriangleMesh& mesh) = 0;

    // Builds anew what queries need; timed. What was built before is let go by forget(), which is not timed.
    virtual void build() = 0;
    virtual void forget() = 0;

    // distances[i]: from points.row(i) to the mesh, as this program computes it; each query starts with nothing known.
    // Timed.
    virtual void distances(const Points& points, std::vector<double>& distances) = 0;

    virtual std::size_t bytes() const { return 0; }  // of what build() made; 0: not known
};

std::unique_ptr<ClosestRival> bvh_rival();
std::unique_ptr<ClosestRival> bvh_warm_rival();  // each query is told the triangle that answered the one before
std::unique_ptr<ClosestRival> octree_rival();
std::unique_ptr<ClosestRival> blocks_rival();

// Null where the program was built without them.
std::unique_ptr<ClosestRival> embree_rival();
std::unique_ptr<ClosestRival> cgal_rival();

}  // namespace hausbench
