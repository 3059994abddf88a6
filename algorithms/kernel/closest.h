// Closest point queries: the query, its answer, and the plain scan that every structure must match bit for bit.
#pragma once

#include "algorithms/kernel/counters.h"
#include "algorithms/kernel/point_triangle.h"

#include <limits>

namespace hausbench {

struct ClosestPoint {
    double squared_distance = std::numeric_limits<double>::infinity();
    Vec3 point = Vec3::Zero();  // on the triangle
    Index triangle = -1;        // ties go to the lowest index
};

// Optional hints of a query. They change its answer only as described here.
struct ClosestHints {
    // Only triangles with squared distance <= this are considered; `triangle` stays -1 if there is none.
    double squared_radius = std::numeric_limits<double>::infinity();
    // Early-out: stop at the first triangle whose squared distance is at most this, and return it instead of the
    // closest one. Negative: never.
    double early_out_squared = -1;
    // This triangle is tested first, if it seems near, so that the search starts with a small radius; -1: none.
    // Without early-out the answer has the same bits.
    Index warm_triangle = -1;
};

// Keeps the smaller squared distance; ties go to the lower index.
inline void offer(ClosestPoint& best, const TrianglePoint& candidate, Index triangle) {
    const double squared = candidate.squared_distance;
    if (squared > best.squared_distance) return;
    if (squared == best.squared_distance && best.triangle >= 0 && best.triangle < triangle) return;
    best = {squared, candidate.point, triangle};
}

// Returns the smallest answer of closest_point(point, triangle) (point_triangle.h) over all triangles of `mesh`, by
// testing each of them. O(n).
ClosestPoint closest_by_scan(const TriangleMesh& mesh, const Vec3& point, const ClosestHints& hints,
                             Counters& counters);

// Returns a lower bound of the distance from `point` to the exact mesh, valid under rounding: the least of one
// number per triangle. That is distance_certainly_at_least (point_triangle.h) for a triangle whose box is within
// the computed distance of the closest triangle, and this computed distance, rounded down, for all others. O(n).
double certified_distance_by_scan(const TriangleMesh& mesh, const Vec3& point, Counters& counters);

// Adds one triangle to that: lowers `least` to the certified distance of `triangle` if its box is within `nearest`
// (squared).
void certify(const Vec3& point, const Triangle& triangle, double nearest, double& least, Counters& counters);

}  // namespace hausbench
