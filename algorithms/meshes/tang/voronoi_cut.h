// Voronoi subdivision (Tang et al. 2009, section 5.2). An edge whose ends have different nearest triangles of B is
// cut where it is equidistant from the planes of the two triangles. Any other edge, or an edge without such a place,
// is cut at its midpoint.
//
// Ours: a cut leaves at least the fraction `least_part` of the edge on either side, so that pieces shrink, and from
// depth `voronoi_depth` on edges are cut at midpoints. A `least_part` of 0.25 keeps pieces more compact than 0.05: it
// took 0.78 to 0.96 times as many subdivisions on six pairs of real meshes at 1e-6 of the diagonal (bunny to its
// half: 212,807 instead of 248,679; midpoints: 304,169). If neighbours in B lie in one plane, as in a subdivided
// mesh, cuts do not find their common edge. There `midpoint` finds it if B was cut at midpoints (elephant to its
// refinement: 12,448 instead of 20,708).
#pragma once

#include "algorithms/kernel/rounding.h"
#include "algorithms/search/cut_options.h"
#include "algorithms/search/piece_bounds.h"

namespace hausbench {

inline constexpr int voronoi_depth = 16;

// Returns the fraction of the edge before the cut between two triangles of B; 0.5 if they do not determine one.
double voronoi_place(const Vec3& from, const Vec3& to, const Triangle& one, const Triangle& two, double least_part);

class PieceCutter {
public:
    // Keeps the reference. `magnitude` as in kernel/rounding.h.
    PieceCutter(const Target& target, double magnitude, Cutting cutting, double least_part)
        : target_(target), magnitude_(magnitude), cutting_(cutting), least_part_(least_part) {}

    // Returns the level at which a piece is smaller than its rounding error (subdivision.h).
    int most_levels() const {
        if (cutting_ == Cutting::longest_edge) return hausbench::most_levels(Split::longest_edge);
        return hausbench::most_levels(Split::midpoint) +
               (cutting_ == Cutting::voronoi ? level_of_long_edge * voronoi_depth : 0);
    }

    // Returns whether the parts of a piece, at subdivision depth `depth`, are cut at the Voronoi boundary.
    bool is_voronoi(int depth) const { return cutting_ == Cutting::voronoi && depth <= voronoi_depth; }

    // Returns the level of rounding of the parts of a piece.
    int level_of_parts(const PieceCorners& corners, int level, int depth) const;

    // Cuts a piece; `measure` as in subdivision.h.
    template <class Measure>
    Cut<MeasuredPoint> cut(const PieceCorners& corners, int depth, const Measure& measure) const {
        if (cutting_ == Cutting::longest_edge) return cut_triangle(corners, Split::longest_edge, measure);
        if (!is_voronoi(depth)) return cut_triangle(corners, Split::midpoint, measure);
        const auto place = [&](const MeasuredPoint& one, const MeasuredPoint& two) {
            double t = 0.5;
            if (one.triangle != two.triangle)
                t = voronoi_place(one.point, two.point, target_.triangle(one.triangle), target_.triangle(two.triangle),
                                  least_part_);
            return point_of_edge(one.point, two.point, t);
        };
        return cut_in_four(corners, place, measure);
    }

private:
    const Target& target_;
    double magnitude_;
    Cutting cutting_;
    double least_part_;
};

}  // namespace hausbench
