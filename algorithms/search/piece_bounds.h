// Upper bounds of h(T, B) for a piece T of a triangle of A, from its corners v1, v2, v3, their distances to B and
// the triangles S1, S2, S3 of B nearest to them. Sacht and Jacobson 2024, section 3.2, call the four bounds of
// their cascade u1 to u4.
//
// They rest on two facts. The distance to a convex set (a triangle, a point) is convex, so over a polygon it is
// largest at a corner. And the parts of T cover it wherever it is cut: the place of a cut decides whether a bound
// is tight, not whether it holds. So rounding matters only in lengths that are added or compared, and in the
// distance of a computed point from T.
//
// Each bound holds for the exact piece behind a piece whose corners were rounded `level` times (kernel/rounding.h).
#pragma once

#include "algorithms/kernel/rounding.h"
#include "algorithms/search/target.h"

#include <array>
#include <limits>
#include <optional>

namespace hausbench {

using PieceCorners = std::array<MeasuredPoint, 3>;

// Returns g: no point of the triangle is farther than this from its nearest corner. This is the circumradius of an
// acute triangle, and half of the longest edge of any other.
double covering_radius_at_most(const std::array<Vec3, 3>& corners);

// Returns the barycentre, which is within level_of_inner_point of the piece.
inline Vec3 barycentre(const PieceCorners& v) { return (v[0].point + v[1].point + v[2].point) / 3.0; }

// Why a bound holds: how the piece is cut into cells, each near one triangle of B.
struct PieceArgument {
    enum class Kind {
        // The whole piece is near triangle `near`.
        one,
        // A cell for each corner, with the points nearest to it, against the S of that corner.
        nearest_corner,
        // Corner `alone` is cut off at `ends`, against its S; the rest against the S of the other two corners.
        corner_cut_off,
        // Three quadrilaterals, each with a corner, the midpoints beside it and the barycentre, against the S of
        // that corner.
        three,
        // Two cells, with the points nearest to the closest point of one of two corners, against the S of that
        // corner.
        nearest_foot
    };
    Kind kind = Kind::one;
    Index near = -1;
    std::size_t alone = 0;
    // The values, at corner `alone` and the two after it, of a function that is linear along the edges; the piece
    // is cut where it is zero.
    std::array<double, 3> ends{};
    // At each corner, positive if the foot of the second of `feet` is nearer. Also linear along the edges.
    std::array<double, 3> nearer{};
    std::array<std::size_t, 2> feet{};
};

class PieceBounds {
public:
    // Keeps references; `magnitude` as in kernel/rounding.h. Counts distances to single triangles, and every bound
    // as a test.
    PieceBounds(const Target& target, double magnitude, Counters& counters)
        : target_(target), magnitude_(magnitude), counters_(counters) {}

    // Exact if one triangle of B is named nearest to all three corners (Eq. 6); infinite otherwise.
    double same_triangle(const PieceCorners& corners, int level);

    // The same if some S_i is as near to all three corners as any, but ties named other triangles: at shared edges
    // and vertices of B.
    double tied_triangle(const PieceCorners& corners, int level);

    // A corner's distance plus its longest edge (Eq. 9).
    double u1(const PieceCorners& corners, int level);
    // The largest corner distance plus covering_radius (Eq. 11).
    double u2(const PieceCorners& corners, int level);
    // Kang et al. 2018: T is cut in two or three, each part against its S (Eqs. 14, 18).
    double u3(const PieceCorners& corners, int level);
    // From pairs of the corners' closest points (Eq. 19).
    double u4(const PieceCorners& corners, int level);

    // Returns the argument of the bound that was computed last, unless that was infinite.
    const PieceArgument& argument() const { return argument_; }
    void restore(const PieceArgument& argument) { argument_ = argument; }

    // Zheng et al. 2022: the least of the h(T, S_i) or, if `fourth` >= 0, h(T, that triangle).
    double nearest_triangles(const PieceCorners& corners, int level, Index fourth = -1);

private:
    double at_most(double squared, int level) const { return surface_distance_at_most(squared, magnitude_, level); }
    double squared_to_triangle(const PieceCorners& corners, Index triangle);
    double in_two(const PieceCorners& corners, std::size_t alone);
    double in_three(const PieceCorners& corners, double& whole, Index& near);
    void by_one(Index near) {
        argument_.kind = PieceArgument::Kind::one;
        argument_.near = near;
    }
    BlockFeet distances(const std::array<Vec3, 7>& points, std::size_t count, Index triangle);

    const Target& target_;
    double magnitude_;
    Counters& counters_;
    PieceArgument argument_;
};

}  // namespace hausbench
