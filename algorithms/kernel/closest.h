// Closest point queries on a mesh: the answer, optional hints, and the plain scan over all triangles, whose answer
// every search structure must match bit for bit.
#pragma once

#include "algorithms/kernel/counters.h"
#include "algorithms/kernel/point_triangle.h"

#include <limits>

namespace hausbench {

// The answer to a query.
struct ClosestPoint {
    double squared_distance = std::numeric_limits<double>::infinity();
    Vec3 point = Vec3::Zero();  // on `triangle`, up to rounding
    Index triangle = -1;        // the lowest index if several triangles are equally near; -1 if there is none
};

// Optional hints for a query. They change its answer only as described here.
struct ClosestHints {
    // Only triangles with squared distance <= this are considered. If there is none, the answer has `triangle` -1.
    double squared_radius = std::numeric_limits<double>::infinity();
    // The search stops at the first triangle whose squared distance is at most this, and returns that triangle instead
    // of the closest one. Negative: the search never stops early.
    double early_out_squared = -1;
    // A triangle that is probably near, such as the answer for a neighbouring point; -1 if none is known. A structure
    // may test it first, so that the search starts with a small radius. Unless the search stops early, the answer has
    // the same bits as without this hint.
    Index warm_triangle = -1;
};

// Replaces `best` if the candidate is nearer, or equally near with a lower index.
inline void offer(ClosestPoint& best, const TrianglePoint& candidate, Index triangle) {
    const double squared = candidate.squared_distance;
    if (squared > best.squared_distance) return;
    if (squared == best.squared_distance && best.triangle >= 0 && best.triangle < triangle) return;
    best = {squared, candidate.point, triangle};
}

// Finds the closest triangle by calling closest_point (point_triangle.h) for each triangle of `mesh`. O(n).
ClosestPoint closest_by_scan(const TriangleMesh& mesh, const Vec3& point, const ClosestHints& hints,
                             Counters& counters);

// Returns a proven lower bound on the exact distance from `point` to the mesh: the smallest of one lower bound per
// triangle. Let f be the computed distance to the closest triangle. For a triangle whose box is at most f away, the
// lower bound is distance_certainly_at_least (point_triangle.h); for all others, it is f, rounded down. O(n).
double certified_distance_by_scan(const TriangleMesh& mesh, const Vec3& point, Counters& counters);

// One step of certified_distance_by_scan: lowers `least` to the lower bound of `triangle` if that is smaller. Does
// nothing if the squared distance to the triangle's box is more than `nearest`, which is f squared.
void certify(const Vec3& point, const Triangle& triangle, double nearest, double& least, Counters& counters);

}  // namespace hausbench
