#include "algorithms/search/target.h"

#include "algorithms/kernel/textbook.h"
#include "algorithms/kernel/watched.h"

namespace hausbench {
namespace {

ClosestPoint textbook_closest_by_scan(const TriangleMesh& mesh, const Vec3& point, Counters& counters) {
    ClosestPoint best;
    ++counters.closest_point_queries;
    for (Index i = 0; i < mesh.triangles.rows(); ++i) {
        ++counters.point_triangle_distances;
        const TrianglePoint foot = textbook_closest_point(point, triangle_of(mesh, i));
        if (foot.squared_distance <= best.squared_distance) offer(best, foot, i);
    }
    return best;
}

}  // namespace

ClosestPoint Target::closest(const Vec3& point, Index warm, Counters& counters) const {
    ClosestHints hints;
    hints.warm_triangle = warm;
    if (grid_) return grid_->closest(point, hints, counters);
    if (blocks_) return blocks_->closest(point, hints, counters);
    if (!textbook_)
        return tree_ ? tree_->closest(point, hints, counters) : closest_by_scan(mesh_, point, hints, counters);

    ClosestPoint best =
        tree_ ? tree_->textbook_closest(point, hints, counters) : textbook_closest_by_scan(mesh_, point, counters);
    // All distances were NaN, so no triangle was found: return the first one.
    if (best.triangle < 0) best = {best.squared_distance, triangle(0).a, 0};
    return best;
}

double Target::squared_distance(const Vec3& point, const Triangle& triangle) const {
    return (textbook_ ? textbook_closest_point(point, triangle) : closest_point(point, triangle)).squared_distance;
}

void Target::squared_distances(const PointBlock& block, std::size_t count, const Triangle& triangle,
                               BlockFeet& feet) const {
    if (!textbook_) return closest_points(block, triangle, feet);
    for (std::size_t k = 0; k < count; ++k) {
        const Vec3 point(block.coordinate[0][k], block.coordinate[1][k], block.coordinate[2][k]);
        feet.squared_distance[k] = textbook_closest_point(point, triangle).squared_distance;
    }
}

double Target::certified_distance(const Vec3& point, Counters& counters) const {
    if (grid_) return grid_->certified_distance(point, counters);
    if (blocks_) return blocks_->certified_distance(point, counters);
    return tree_ ? tree_->certified_distance(point, counters)
                 : WATCHED_ELSE("search: the witness is certified by support planes",
                                certified_distance_by_scan(mesh_, point, counters),
                                std::sqrt(closest(point, -1, counters).squared_distance));
}

}  // namespace hausbench
