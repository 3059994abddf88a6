// Programs that answer closest-point queries on the triangles of a mesh; compare.cpp times them against each other.
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

    // Converts the mesh into the form that the program needs (Embree: single precision). Not
    // timed. `mesh` must outlive this.
    virtual void take(const TriangleMesh& mesh) = 0;

    // Builds the structures for queries anew; timed. forget() frees them, which is not timed.
    virtual void build() = 0;
    virtual void forget() = 0;

    // Computes distances[i] from points.row(i) to the mesh, in the program's own precision; each
    // query starts without a hint. Timed.
    virtual void distances(const Points& points, std::vector<double>& distances) = 0;

    virtual std::size_t bytes() const { return 0; }  // size of the structures from build(); 0: not known
};

std::unique_ptr<ClosestRival> bvh_rival();
std::unique_ptr<ClosestRival> bvh_warm_rival();  // each query starts with the triangle that answered the previous one
std::unique_ptr<ClosestRival> octree_rival();
std::unique_ptr<ClosestRival> blocks_rival();

// Null if the program was built without them.
std::unique_ptr<ClosestRival> embree_rival();
std::unique_ptr<ClosestRival> cgal_rival();

}  // namespace hausbench
