// What one measured point settles of a group of triangles.
#include "algorithms/kernel/posed_box.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/meshes/cover/worker.h"

#include <cmath>
#include <limits>

namespace hausbench {
namespace {

constexpr std::size_t most_looked_at = 32;  // on either side of the middle of a group, for a partner

}  // namespace

// No point of the box is farther from B than `at` is, and the way there.
double CoverWorker::around(const Vec3& at, double distance, const Box& box) const {
    return surface_sum_at_most(distance + std::sqrt(squared_distance_at_most(at, box)), scene_.magnitude, 0);
}

// A corner of one of a group's triangles that has a partner, and its distance to that: to B it is no larger. Those in the middle are
// looked at first: their corners are measured where nothing is known.
bool CoverWorker::from_partner(const Cluster& group, const Box& box, Landmark& landmark) {
    if (!scene_.partner) return false;
    const std::size_t middle = group.begin + group.count / 2, end = group.begin + group.count;
    for (std::size_t away = 0; away < most_looked_at; ++away) {
        for (const std::size_t i : {middle + away, middle - away}) {
            if (i < group.begin || i >= end || (away == 0 && i != middle)) continue;
            const Index source = scene_.order[i], near = scene_.partner[source];
            if (near < 0) continue;
            ++outcome_.counters.point_triangle_distances;
            landmark = central_corner(source, box);
            landmark.near = near;
            landmark.distance = std::sqrt(scene_.target.squared_distance(landmark.at, scene_.target.triangle(near)));
            return true;
        }
    }
    return false;
}

// The corner of a triangle that the box is least around.
Landmark CoverWorker::central_corner(Index source, const Box& box) const {
    Landmark landmark;
    double least = std::numeric_limits<double>::infinity();
    for (const Index v : scene_.a.triangles.row(source)) {
        const Vec3 corner = scene_.points.row(v);
        const double far = squared_distance_at_most(corner, box);
        if (far < least) {
            least = far;
            landmark.at = corner;
            landmark.vertex = v;
        }
    }
    return landmark;
}

void CoverWorker::narrow(const Cluster& group, const Box& box) {
    Cluster part = group;
    bool known = group.landmark.near >= 0, seeded = false;
    const auto upper = [&] {
        return KnownUpper{around(part.landmark.at, part.landmark.distance, box), part.landmark.near,
                          part.landmark.vertex};
    };
    if (known) part.upper.improve(upper());
    if (Landmark other; part.upper.value > tau_ && from_partner(part, box, other)) {
        const double value = around(other.at, other.distance, box);
        seeded = scene_.partner[middle_of(part)] >= 0;
        if (value < part.upper.value && (seeded || value <= tau_)) {
            part.landmark = other;
            part.upper = {value, other.near, other.vertex};
            known = true;
        }
    }
    ++outcome_.counters.bound_tests;
    // A query is worth its cost only where tau is not far below the size of the group.
    const double size = std::sqrt(squared_length(box.high - box.low));
    if (!known || (!seeded && part.upper.value > tau_ && tau_ >= 0.25 * size && !stop_)) {
        const Index source = middle_of(part);
        const Index near = part.landmark.near;
        part.landmark = central_corner(source, box);
        const MeasuredPoint m = measure(part.landmark.at, near, source, 0);
        part.landmark.near = m.triangle;
        part.landmark.distance = std::sqrt(m.squared);
        part.upper.improve(upper());
        if (scene_.partner) scene_.partner[source] = m.triangle;
    }
    if (part.upper.value > tau_)
        outcome_.groups.push_back(part);
    else
        settle(part);
}

}  // namespace hausbench
