// Types for closest point queries on a mesh, and a brute-force implementation that scans all triangles. Every search
// structure must give the same bits as this scan.
#pragma once

#include "algorithms/kernel/counters.h"
#include "algorithms/kernel/point_triangle.h"

#include <limits>

namespace hausbench {

// The answer to a closest point query.
struct ClosestPoint {
    double squared_distance = std::numeric_limits<double>::infinity();
    Vec3 point = Vec3::Zero();  // on `triangle`, up to rounding
    Index triangle = -1;        // the lowest index if several triangles are equally near; -1 if there is none
};

// Optional limits and hints for a closest point query.
struct ClosestHints {
    // Triangles whose squared distance is larger are ignored. If none remains, `triangle` is -1 in the answer.
    double squared_radius = std::numeric_limits<double>::infinity();
    // The search stops at the first triangle whose squared distance is at most this, and returns that triangle instead
    // of the closest one. A negative value disables this.
    double early_out_squared = -1;
    // A triangle that is probably near, such as the answer for a neighbouring point; -1 if none is known. A structure
    // may test it first, to start with a small search radius. This changes the answer only if the search stops early.
    Index warm_triangle = -1;
};

// Replaces `best` with the candidate if the candidate is nearer, or is equally near and has a lower index.
inline void offer(ClosestPoint& best, const TrianglePoint& candidate, Index triangle) {
    const double squared = candidate.squared_distance;
    if (squared > best.squared_distance) return;
    if (squared == best.squared_distance && best.triangle >= 0 && best.triangle < triangle) return;
    best = {squared, candidate.point, triangle};
}

// Finds the closest triangle by calling closest_point() (point_triangle.h) for every triangle of `mesh`. O(n).
ClosestPoint closest_by_scan(const TriangleMesh& mesh, const Vec3& point, const ClosestHints& hints,
                             Counters& counters);

// Returns a proven lower bound on the exact distance from `point` to the mesh: the smallest of the lower bounds for all
// triangles. A triangle whose box is farther away than the computed distance to the mesh gets this distance, rounded
// down, as its lower bound. The others get distance_certainly_at_least() (point_triangle.h). O(n).
double certified_distance_by_scan(const TriangleMesh& mesh, const Vec3& point, Counters& counters);

// Lowers `least` to a proven lower bound on the distance from `point` to `triangle`, if that is smaller. Does nothing
// if the triangle's box is farther away than `nearest`, the computed squared distance to the closest triangle. One step
// of certified_distance_by_scan().
void certify(const Vec3& point, const Triangle& triangle, double nearest, double& least, Counters& counters);

}  // namespace hausbench
