#include "cover_groups.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace hausbench {

namespace {

constexpr std::size_t most_first_groups = 64, group_parts = 4;

}  // namespace

GroupBoxes::GroupBoxes(const Triangles& triangles, const Points& points, const std::vector<Index>& order) : boxes_(1) {
    boxes_[0].resize((order.size() + cluster_triangles - 1) / cluster_triangles);
    for (std::size_t i = 0; i < order.size(); ++i)
        for (const Index v : triangles.row(order[i])) boxes_[0][i / cluster_triangles].add(Vec3(points.row(v)));
    while (boxes_.back().size() > most_first_groups) {
        const std::vector<Box>& below = boxes_.back();
        std::vector<Box> level((below.size() + group_parts - 1) / group_parts);
        for (std::size_t i = 0; i < below.size(); ++i) level[i / group_parts].add(below[i]);
        boxes_.push_back(std::move(level));
    }
}

void order_clusters(std::vector<Cluster>& clusters, std::size_t first) {
    const auto middle = static_cast<std::ptrdiff_t>(std::min(first, clusters.size()));
    std::vector<std::size_t> best(clusters.size());
    std::iota(best.begin(), best.end(), std::size_t{0});
    // Far from B, or large and perhaps far in a part.
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

}  // namespace hausbench
