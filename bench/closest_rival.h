// Closest-point queries on a triangle mesh, answered by this project, by Embree or by CGAL, behind one interface;
// compare.cpp times them against each other.
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

    // Converts the mesh into the form that the library reads (Embree: single precision). Not timed. `mesh` must outlive
    // this object.
    virtual void take(const TriangleMesh& mesh) = 0;

    // build() builds the search structures for the mesh of take(), and is timed. forget() frees them, so that build()
    // can be timed again; it is not timed.
    virtual void build() = 0;
    virtual void forget() = 0;

    // Computes distances[i], the distance from points.row(i) to the mesh, in the library's own precision. Timed. No
    // query uses the answer to an earlier one, except in bvh_warm_rival().
    virtual void distances(const Points& points, std::vector<double>& distances) = 0;

    virtual std::size_t bytes() const { return 0; }  // size of the structures that build() made; 0: unknown
};

std::unique_ptr<ClosestRival> bvh_rival();
std::unique_ptr<ClosestRival> bvh_warm_rival();  // each query first tests the closest triangle of the previous query
std::unique_ptr<ClosestRival> octree_rival();
std::unique_ptr<ClosestRival> blocks_rival();

// Return null if this program was built without the library.
std::unique_ptr<ClosestRival> embree_rival();
std::unique_ptr<ClosestRival> cgal_rival();

}  // namespace hausbench
