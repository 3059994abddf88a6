// Voronoi subdivision (Tang et al. 2009, section 5.2). If the ends of an edge have different nearest triangles of B,
// the edge is cut at the point that is equally far from the planes of these triangles. Any other edge, or an edge
// without such a point, is cut at its midpoint.
//
// Not in the paper: both parts of an edge keep at least the fraction `least_part` of its length, so that pieces shrink.
// After `voronoi_depth` cuts, all further cuts are at midpoints.
//
// Measurements: `least_part` is 0.05 by default. With 0.25, pieces stay more compact: six pairs of real meshes took
// 0.78 to 0.96 times as many subdivisions, at a tolerance of 1e-6 of the diagonal. If neighbouring triangles of B lie
// in one plane, as in a mesh subdivided at midpoints, the choice `midpoint` of the parameter `split` is better, because
// its cuts meet the edges of B (12,448 subdivisions instead of 20,708 for one such mesh). With noise on such a mesh the
// difference is large: bull -> bull_subdivided_noisy takes 542,602 subdivisions, or 13,070 at midpoints, a tenth of the
// time. Which triangle is nearest to a corner is then a matter of noise, and the planes of two such triangles may be
// equally far anywhere. It does not help to choose the bisecting plane that comes nearest to equal distances from the
// triangles themselves (820,048 subdivisions).
#pragma once

#include "algorithms/kernel/rounding.h"
#include "algorithms/search/cut_options.h"
#include "algorithms/search/piece_bounds.h"

namespace hausbench::tang {

inline constexpr int voronoi_depth = 16;

// Returns where to cut an edge, as a fraction of its length from `from`: at the point equally far from the planes of
// the triangles `one` and `two`, but not nearer to either end than the fraction `least_part`. Returns 0.5 if no such
// point exists.
double voronoi_place(const Vec3& from, const Vec3& to, const Triangle& one, const Triangle& two, double least_part);

// Cuts pieces of A by the method that the solver's parameter `split` chooses (search/cut_options.h).
class PieceCutter {
public:
    // Keeps the reference. `magnitude` is the largest |coordinate| of A and B (M in kernel/rounding.h).
    PieceCutter(const Target& target, double magnitude, Cutting cutting, double least_part)
        : target_(target), magnitude_(magnitude), cutting_(cutting), least_part_(least_part) {}

    // Returns the rounding level (kernel/rounding.h) at which a piece is smaller than its rounding errors, so that
    // further cuts are useless.
    int most_levels() const {
        if (cutting_ == Cutting::longest_edge) return hausbench::most_levels(Split::longest_edge);
        return hausbench::most_levels(Split::midpoint) +
               (cutting_ == Cutting::voronoi ? level_of_long_edge * voronoi_depth : 0);
    }

    // Returns whether a piece at this depth is made by a Voronoi cut. The depth is the number of cuts from a whole
    // triangle.
    bool is_voronoi(int depth) const { return cutting_ == Cutting::voronoi && depth <= voronoi_depth; }

    // Returns the rounding level (kernel/rounding.h) of the parts into which a piece of level `level` is cut. `depth`
    // is the depth of the parts.
    int level_of_parts(const PieceCorners& corners, int level, int depth) const;

    // Cuts a piece into parts of the given depth. Calls measure(point, near) to make each new vertex; see cut_in_four()
    // in subdivision.h.
    template <class Measure>
    Cut<MeasuredPoint> cut(const PieceCorners& corners, int depth, const Measure& measure) const {
        if (cutting_ == Cutting::longest_edge) return cut_triangle(corners, Split::longest_edge, measure);
        if (!is_voronoi(depth)) return cut_triangle(corners, Split::midpoint, measure);
        const auto place = [&](const MeasuredPoint& from, const MeasuredPoint& to) {
            double t = 0.5;
            if (from.triangle != to.triangle)
                t = voronoi_place(from.point, to.point, target_.triangle(from.triangle), target_.triangle(to.triangle),
                                  least_part_);
            return point_of_edge(from.point, to.point, t);
        };
        return cut_in_four(corners, place, measure);
    }

private:
    const Target& target_;
    double magnitude_;
    Cutting cutting_;
    double least_part_;
};

}  // namespace hausbench::tang
