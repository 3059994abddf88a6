#include "point_recipes.h"

#include "random.h"

#include <cmath>
#include <vector>

namespace hausbench {
namespace {

// Close to normal, variance 1: the sum of 12 uniform numbers less 6. Takes 36 numbers for a vector.
Vec3 normal(const Random& random, std::uint64_t which) {
    Vec3 vector;
    std::uint64_t counter = 36 * which;
    for (int k = 0; k < 3; ++k) {
        double sum = 0;
        for (int j = 0; j < 12; ++j) sum += random.uniform(counter++);
        vector[k] = sum - 6;
    }
    return vector;
}

Vec3 uniform(const Random& random, std::uint64_t which) {
    return {random.uniform(3 * which), random.uniform(3 * which + 1), random.uniform(3 * which + 2)};
}

// One point for each number of the sequence.
template <class F> PointSet each(Index count, F&& point) {
    PointSet set{Points(count, 3)};
    for (Index i = 0; i < count; ++i) set.points.row(i) = point(static_cast<std::uint64_t>(i)).transpose();
    return set;
}

}  // namespace

PointSet gaussian_points(Index count, std::uint64_t seed, double sigma, const Vec3& centre) {
    const Random random(seed);
    return each(count, [&](std::uint64_t i) -> Vec3 { return centre + sigma * normal(random, i); });
}

PointSet box_points(Index count, std::uint64_t seed, const Vec3& size) {
    const Random random(seed);
    return each(count, [&](std::uint64_t i) -> Vec3 { return uniform(random, i).cwiseProduct(size); });
}

PointSet curve_points(Index count, std::uint64_t seed) {
    const Random random(seed);
    return each(count, [&](std::uint64_t i) -> Vec3 {
        const double t = random.uniform(i);
        return {t, t * t, t * t * t};
    });
}

PointSet shell_points(Index count, std::uint64_t seed, double radius, const Vec3& centre) {
    const Random random(seed);
    return each(count, [&](std::uint64_t i) -> Vec3 {
        const Vec3 v = normal(random, i);
        const double length = std::sqrt(v.x() * v.x() + v.y() * v.y() + v.z() * v.z());
        return length > 0 ? Vec3(centre + radius * (v / length)) : Vec3(centre + Vec3(radius, 0, 0));
    });
}

PointSet cluster_points(Index count, std::uint64_t seed, const Clusters& clusters) {
    const Random random(seed), layout(clusters.layout);
    std::vector<Vec3> centres;
    std::vector<double> sigmas;
    double sigma = clusters.sigma;
    for (Index c = 0; c < clusters.count; ++c) {
        centres.emplace_back(clusters.spread * uniform(layout, static_cast<std::uint64_t>(c)));
        sigmas.push_back(sigma);
        sigma *= clusters.shrink;
    }
    return each(count, [&](std::uint64_t i) -> Vec3 {
        const auto c = static_cast<std::size_t>(i) % centres.size();
        return centres[c] + sigmas[c] * normal(random, i);
    });
}

}  // namespace hausbench
