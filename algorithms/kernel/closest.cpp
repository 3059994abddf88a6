#include "algorithms/kernel/closest.h"

#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <limits>

namespace hausbench {

ClosestPoint closest_by_scan(const TriangleMesh& mesh, const Vec3& point, const ClosestHints& hints,
                             Counters& counters) {
    ++counters.closest_point_queries;
    ClosestPoint best;
    best.squared_distance = hints.squared_radius;
    for (Index i = 0; i < mesh.triangles.rows(); ++i) {
        ++counters.point_triangle_distances;
        offer(best, closest_point(point, triangle_of(mesh, i)), i);
        if (best.triangle >= 0 && best.squared_distance <= hints.early_out_squared) break;
    }
    return best;
}

void certify(const Vec3& point, const Triangle& triangle, double nearest, double& least, Counters& counters) {
    if (squared_distance_to_box(point, box_of(triangle)) > nearest) return;
    ++counters.point_triangle_distances;
    // Use the same order of corners as search trees, the longest edge first, so that results have the same bits.
    const Triangle turned = longest_edge_first(triangle);
    const TrianglePoint foot = closest_point(point, turned);
    if (WATCHED("certified_distance_by_scan: each triangle's own bound", true))
        least = std::min(least, distance_certainly_at_least(point, turned, foot.point));
}

double certified_distance_by_scan(const TriangleMesh& mesh, const Vec3& point, Counters& counters) {
    const double nearest = closest_by_scan(mesh, point, {}, counters).squared_distance;
    double least = WATCHED_ELSE("certified_distance_by_scan: triangles that are left out",
                                distance_at_least(nearest, true), std::numeric_limits<double>::infinity());
    for (Index i = 0; i < mesh.triangles.rows(); ++i) {
        certify(point, triangle_of(mesh, i), nearest, least, counters);
    }
    return least;
}

}  // namespace hausbench
