#include "algorithms/meshes/tang/voronoi_cut.h"

#include <algorithm>
#include <cmath>

namespace hausbench::tang {

// The points equally far from the planes of both triangles form two planes, which bisect the angles between them. Cuts
// the edge with the bisecting plane that separates the triangles, judging by their centres.
double voronoi_place(const Vec3& from, const Vec3& to, const Triangle& one, const Triangle& two, double least_part) {
    const auto normal = [](const Triangle& t) { return Vec3((t.b - t.a).cross(t.c - t.a).normalized()); };
    const auto centre = [](const Triangle& t) { return Vec3((t.a + t.b + t.c) / 3.0); };
    const Vec3 n = normal(one), m = normal(two);
    const auto from_one = [&](const Vec3& p) { return dot(n, p - one.a); };
    const auto from_two = [&](const Vec3& p) { return dot(m, p - two.a); };
    const double sign = from_one(centre(two)) * from_two(centre(one)) < 0 ? -1 : 1;
    const double at_from = from_one(from) - sign * from_two(from), at_to = from_one(to) - sign * from_two(to);
    const double t = at_from / (at_from - at_to);
    // at_from and at_to are the differences between the distances to the two planes, at the ends of the edge. If they
    // are almost equal, because the planes nearly coincide or the edge is parallel to the bisecting plane, rounding
    // decides where the difference is 0. Cut at the midpoint instead.
    const bool clear = std::abs(at_from - at_to) > 1e-6 * std::sqrt(squared_length(to - from));
    return clear && t > 0 && t < 1 ? std::clamp(t, least_part, 1 - least_part) : 0.5;
}

int PieceCutter::level_of_parts(const PieceCorners& corners, int level, int depth) const {
    if (!is_voronoi(depth)) return level + 1;
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 edge = corners[k].point - corners[(k + 1) % 3].point;
        longest = std::max(longest, edge.cwiseAbs().maxCoeff());
    }
    return level + level_of_point_of_edge(longest, magnitude_);
}

}  // namespace hausbench::tang
