// Hints that a mesh solver carries from one pose of A to the next: nearest triangles and the farthest point.
//
// Hints only decide which triangles and points come first. Bounds are proven anew at each pose, so bad hints cost only
// time. The papers do not describe hints, so a solver uses them only if the caller passes a state.
#pragma once

#include "algorithms/kernel/point_triangle.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/search/bounds.h"
#include "algorithms/solver.h"

#include <algorithm>
#include <vector>

namespace hausbench {

struct WarmStart final : State {
    // The triangle of B nearest to each vertex of A; -1: unknown. Empty before the first pose.
    std::vector<Index> nearest;
    Index source = -1;             // triangle of A that contained the farthest point; -1: unknown
    int corner = -1;               // the corner of `source` that was the farthest point; -1: it was not a corner
    double second = 0, third = 0;  // if corner is -1: weights of the second and third corner, in [0, 1]
    Index target = -1;             // triangle of B nearest to the farthest point
    // For each triangle of A, a triangle of B that was near it; unknown if the entry is -1 or missing. When the solver
    // computes h(B, A), these pairs tell which triangle of A to try first for a triangle of B (Tang et al. 2009,
    // section 6).
    std::vector<Index> partner;
    // For each node of a tree over A, then for each leaf, a triangle of B near it; -1: unknown.
    std::vector<Index> near_node;

    // Adds the pairs of `partner` that the search for h(B, A) found, with A and B exchanged. Pairs already known here
    // are kept.
    void learn_from(const State& opposite) override {
        const auto& other = static_cast<const WarmStart&>(opposite).partner;
        for (std::size_t t = 0; t < other.size(); ++t) {
            if (other[t] < 0) continue;
            const auto s = static_cast<std::size_t>(other[t]);
            if (s >= partner.size()) partner.resize(s + 1, -1);
            if (partner[s] < 0) partner[s] = static_cast<Index>(t);
        }
    }

    // Saves the farthest point of a search. `triangle` is triangle `farthest.source` of A, moved by its pose.
    void remember(const Farthest& farthest, const Triangle& triangle) {
        source = farthest.source;
        target = farthest.point.triangle;
        const Vec3& point = farthest.point.point;
        corner = point == triangle.a ? 0 : point == triangle.b ? 1 : point == triangle.c ? 2 : -1;
        // Computes the weights by plain least squares. This is accurate enough for a starting point.
        const Vec3 e = triangle.b - triangle.a, f = triangle.c - triangle.a, p = point - triangle.a;
        const double ee = dot(e, e), ef = dot(e, f), ff = dot(f, f), scale = ee * ff - ef * ef;
        // Returns x / scale, clamped to [0, 1], or 0 if the quotient is NaN.
        const auto weight = [&](double x) {
            return WATCHED_ELSE("warm start: weights are between 0 and 1",
                                x / scale > 0 ? std::min(x / scale, 1.0) : 0.0, x / scale);
        };
        second = weight(ff * dot(e, p) - ef * dot(f, p));
        third = WATCHED("warm start: the weights of both corners", weight(ee * dot(f, p) - ef * dot(e, p)));
    }

    // Returns the point of `triangle`, which is `source` at another pose, with about the same weights as the saved
    // farthest point. Rounding moves it off the triangle by no more than level_of_closest_point allows
    // (kernel/rounding.h).
    Vec3 point_in(const Triangle& triangle) const {
        const Vec3 near = triangle.a + second * (triangle.b - triangle.a) + third * (triangle.c - triangle.a);
        return closest_point(near, triangle).point;
    }
};

}  // namespace hausbench
