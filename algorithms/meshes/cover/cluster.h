// Describes some triangles of A for threshold cover (meshes/cover/cover.cpp), which then covers them.
#pragma once

#include "algorithms/search/target.h"

#include <cstddef>
#include <limits>
#include <vector>

namespace hausbench {

// A point that was measured, near some triangles.
struct Landmark {
    Vec3 at = Vec3::Zero();
    double distance = 0;  // to B, as computed
    Index near = -1;      // triangle of B, nearest to it; -1: nothing was measured
    Index vertex = -1;    // of A that it is, or -1
};

// An upper bound of the distance of some triangles to B, and why: by the distance of this vertex of A to triangle `near` of B and the
// way there; with no vertex, -1, by the distances of all corners to that triangle.
struct KnownUpper {
    double value = std::numeric_limits<double>::infinity();
    Index near = -1, vertex = -1;

    void improve(const KnownUpper& other) {
        if (other.value < value) *this = other;
    }
};

// Triangles of A that follow one another in the order.
struct Cluster {
    std::size_t begin = 0, count = 0;
    KnownUpper upper;
    Landmark landmark;
};

// The most promising first, `first` of them; the others in the order of A, so that neighbours follow one another.
void order_clusters(std::vector<Cluster>& clusters, std::size_t first);

}  // namespace hausbench
