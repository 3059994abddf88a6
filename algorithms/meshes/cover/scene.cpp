#include "algorithms/meshes/cover/scene.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace hausbench::cover {

void order_clusters(std::vector<Cluster>& clusters, std::size_t first) {
    const auto middle = static_cast<std::ptrdiff_t>(std::min(first, clusters.size()));
    std::vector<std::size_t> best(clusters.size());
    std::iota(best.begin(), best.end(), std::size_t{0});
    // A cluster is promising if its landmark is far from B, or if its upper bound is large, so that a part of it may be
    // far from B.
    const auto promise = [&](std::size_t i) { return clusters[i].landmark.distance + 0.3 * clusters[i].upper.value; };
    std::partial_sort(best.begin(), best.begin() + middle, best.end(), [&](std::size_t i, std::size_t j) {
        const double x = promise(i), y = promise(j);
        return x != y ? x > y : i < j;
    });
    std::sort(best.begin() + middle, best.end());
    std::vector<Cluster> ordered;
    ordered.reserve(clusters.size());
    for (const std::size_t i : best) ordered.push_back(clusters[i]);
    clusters = std::move(ordered);
}

double Piece::farthest_corner(const Vec3& from) const {
    double squared = 0;
    for (const Vec3& corner : corners) squared = std::max(squared, squared_length(corner - from));
    return std::sqrt(squared);
}

std::size_t Piece::longest_edge() const {
    std::size_t longest = 0;
    double most = -1;
    for (std::size_t k = 0; k < 3; ++k) {
        const double squared = squared_length(corners[(k + 1) % 3] - corners[k]);
        if (squared > most) {
            most = squared;
            longest = k;
        }
    }
    return longest;
}

}  // namespace hausbench::cover
