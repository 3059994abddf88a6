// Closest point queries: the question, the answer, and the plain scan that every structure must equal to the bit.
#pragma once

#include "algorithms/kernel/counters.h"
#include "algorithms/kernel/point_triangle.h"

#include <limits>

namespace hausbench {

struct ClosestPoint {
    double squared_distance = std::numeric_limits<double>::infinity();
    Vec3 point = Vec3::Zero();  // on the triangle
    Index triangle = -1;        // of several at the same squared distance, the one of lowest index
};

// Hints for a query. Neither changes an answer except as described.
struct ClosestHints {
    // Only triangles with squared distance <= this are looked for; `triangle` stays -1 if there is none.
    double squared_radius = std::numeric_limits<double>::infinity();
    // Early-out: stop as soon as some triangle is at most this far (squared); the answer is then that triangle, not the
    // closest one. Negative: never.
    double early_out_squared = -1;
    // Looked at first, if it seems near, to start with a small radius; -1 for none. Without early-out the answer is the same
    // bits.
    Index warm_triangle = -1;
};

// Keeps the smaller squared distance; among equals the lower index.
inline void offer(ClosestPoint& best, const TrianglePoint& candidate, Index triangle) {
    const double squared = candidate.squared_distance;
    if (squared > best.squared_distance) return;
    if (squared == best.squared_distance && best.triangle >= 0 && best.triangle < triangle) return;
    best = {squared, candidate.point, triangle};
}

// The answer of closest_point(point, triangle) (point_triangle.h) that is smallest over all triangles of `mesh`, by
// testing each. O(n).
ClosestPoint closest_by_scan(const TriangleMesh& mesh, const Vec3& point, const ClosestHints& hints,
                             Counters& counters);

// Returns a lower bound of the distance from `point` to the exact mesh that holds under rounding: the least over all
// triangles of distance_certainly_at_least (point_triangle.h), if the triangle's box is no farther than the closest
// triangle's computed distance, and of that distance (rounded down) otherwise. O(n).
double certified_distance_by_scan(const TriangleMesh& mesh, const Vec3& point, Counters& counters);

// The part of one triangle in it: lowers `least` to the certain distance of this triangle if its box is no farther
// than `nearest` (squared).
void certify(const Vec3& point, const Triangle& triangle, double nearest, double& least, Counters& counters);

}  // namespace hausbench
