#include "datasets/generate.h"
#include "datasets/random.h"

#include <cmath>

namespace hausbench {
namespace {

// Returns a random vector whose coordinates are close to normally distributed, with mean 0 and variance 1: each is the
// sum of 12 uniform numbers, minus 6. Uses the random numbers 36 * which, ..., 36 * which + 35.
Vec3 normal(const RandomNumbers& random, std::uint64_t which) {
    Vec3 vector;
    std::uint64_t counter = 36 * which;
    for (int k = 0; k < 3; ++k) {
        double sum = 0;
        for (int j = 0; j < 12; ++j) sum += random.uniform(counter++);
        vector[k] = sum - 6;
    }
    return vector;
}

// Returns a random point of the cube [0, 1)^3, from the random numbers 3 * which, ..., 3 * which + 2.
Vec3 uniform(const RandomNumbers& random, std::uint64_t which) {
    return {random.uniform(3 * which), random.uniform(3 * which + 1), random.uniform(3 * which + 2)};
}

// Returns the points point(random, i) for all i below the number `count` of the recipe.
template <class F> PointSet each(const Given& g, F&& point) {
    const RandomNumbers random(g.seed());
    PointSet set{Points(g.whole("count"), 3)};
    for (Index i = 0; i < set.points.rows(); ++i)
        set.points.row(i) = point(random, static_cast<std::uint64_t>(i)).transpose();
    return set;
}

PointSet gaussian_points(const Given& g) {
    const double sigma = g.real("sigma");
    return each(g, [&, centre = g.xyz()](const RandomNumbers& random, std::uint64_t i) -> Vec3 {
        return centre + sigma * normal(random, i);
    });
}

PointSet box_points(const Given& g, const Vec3& size) {
    return each(
        g, [&](const RandomNumbers& random, std::uint64_t i) -> Vec3 { return uniform(random, i).cwiseProduct(size); });
}

PointSet curve_points(const Given& g) {
    return each(g, [](const RandomNumbers& random, std::uint64_t i) -> Vec3 {
        const double t = random.uniform(i);
        return {t, t * t, t * t * t};
    });
}

PointSet shell_points(const Given& g) {
    const double radius = g.real("radius");
    return each(g, [&, centre = g.xyz()](const RandomNumbers& random, std::uint64_t i) -> Vec3 {
        const Vec3 v = normal(random, i);
        const double length = std::sqrt(v.x() * v.x() + v.y() * v.y() + v.z() * v.z());
        return length > 0 ? Vec3(centre + radius * (v / length)) : Vec3(centre + Vec3(radius, 0, 0));
    });
}

PointSet cluster_points(const Given& g) {
    const RandomNumbers layout(g.seed("layout"));
    std::vector<Vec3> centres;
    std::vector<double> sigmas;
    double sigma = g.real("sigma");
    for (Index c = 0; c < g.whole("clusters"); ++c) {
        centres.emplace_back(g.real("spread") * uniform(layout, static_cast<std::uint64_t>(c)));
        sigmas.push_back(sigma);
        sigma *= g.real("shrink");
    }
    return each(g, [&](const RandomNumbers& random, std::uint64_t i) -> Vec3 {
        const auto c = static_cast<std::size_t>(i) % centres.size();
        return centres[c] + sigmas[c] * normal(random, i);
    });
}

}  // namespace

std::vector<Recipe> point_recipes() {
    const NumberSpec count = whole_number("count", 1, 1e8), seed = seed_number(), x = coordinate("x"),
                     y = coordinate("y"), z = coordinate("z");
    return {{"gaussian_points",
             "each coordinate is the centre's plus `sigma` times (the sum of 12 uniform numbers, less 6): variance 1, "
             "close to normal, but never beyond 6 `sigma`",
             {count, seed, length("sigma", 0), x, y, z},
             gaussian_points},
            {"uniform_points",
             "uniform in the cube [0, 1)^3",
             {count, seed},
             [](const Given& g) { return box_points(g, Vec3::Ones()); }},
            {"box_points",
             "uniform in [0, `x`) x [0, `y`) x [0, `z`): a line, ribbon or sheet if some are small or 0",
             {count, seed, length("x", 0), length("y", 0), length("z", 0)},
             [](const Given& g) { return box_points(g, g.xyz()); }},
            {"curve_points", "(t, t^2, t^3) for uniform t in [0, 1)", {count, seed}, curve_points},
            {"shell_points", "on a sphere around a centre", {count, seed, length("radius", 0), x, y, z}, shell_points},
            {"cluster_points",
             "centres uniform in [0, `spread`)^3, by the seed `layout`; point i belongs to cluster i mod `clusters`, "
             "and cluster c has standard deviation `sigma` `shrink`^c, as in gaussian_points (`sigma` 0: duplicates; "
             "`spread` 0: all scales around one point)",
             {count, seed, whole_number("clusters", 1, 1e8), seed_number("layout"), length("spread", 0),
              length("sigma", 0), NumberSpec{"shrink", false, 0, 1}},
             cluster_points}};
}

}  // namespace hausbench
