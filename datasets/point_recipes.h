// The recipes for point sets; generate.h says what each makes.
#pragma once

#include "scene.h"

#include <cstdint>

namespace hausbench {

PointSet gaussian_points(Index count, std::uint64_t seed, double sigma, const Vec3& centre);
PointSet box_points(Index count, std::uint64_t seed, const Vec3& size);
PointSet curve_points(Index count, std::uint64_t seed);
PointSet shell_points(Index count, std::uint64_t seed, double radius, const Vec3& centre);

struct Clusters {
    Index count;           // of clusters
    std::uint64_t layout;  // seed of the centres
    double spread;         // edge of the cube that holds the centres
    double sigma;          // of the first cluster
    double shrink;         // sigma of each cluster over that of the one before
};
PointSet cluster_points(Index count, std::uint64_t seed, const Clusters& clusters);

}  // namespace hausbench
