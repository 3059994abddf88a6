// Upper bounds on h(T, B), the largest distance from a point of T to B, for a piece T of a triangle of A. They are
// computed from the corners v1, v2, v3 of T, their distances to B and the triangles S1, S2, S3 of B nearest to
// them. Sacht and Jacobson 2024, section 3.2, call the four bounds of their cascade u1 to u4; the numbers of
// equations below are theirs.
//
// The bounds rest on two facts. The distance to a convex set (a triangle, a point) is a convex function, so over a
// polygon it is largest at a corner. And the parts of T cover T wherever T is cut: the place of a cut decides how tight
// a bound is, not whether it holds. So rounding matters only in lengths that are added or compared, and in the distance
// of a computed point from T.
//
// Each bound holds for the exact piece, although the given corners are rounded: they are the result of `level`
// subdivisions (kernel/rounding.h).
#pragma once

#include "algorithms/kernel/rounding.h"
#include "algorithms/search/target.h"

#include <array>
#include <limits>
#include <optional>

namespace hausbench {

using PieceCorners = std::array<MeasuredPoint, 3>;

// Returns a length such that every point of the triangle is within this length of some corner: the circumradius if the
// triangle is acute, otherwise half of the longest edge. Rounded upward.
double covering_radius_at_most(const std::array<Vec3, 3>& corners);

// Returns the barycentre. Rounding moves it off the piece by no more than level_of_inner_point (kernel/rounding.h).
inline Vec3 barycentre(const PieceCorners& v) { return (v[0].point + v[1].point + v[2].point) / 3.0; }

// The reason why a bound holds: T is cut into *cells*, and for each cell the distance to one triangle of B is bounded.
// The *S of a corner* is the triangle of B nearest to it; the *foot* of a corner is the point of B closest to it.
struct PieceArgument {
    enum class Kind {
        // The whole of T is one cell, near triangle `near`.
        one,
        // Three cells. Each holds the points of T whose nearest corner is the same one, and is near
        // the S of that corner.
        nearest_corner,
        // Two cells, separated by the line on which the function of `ends` is zero. One holds corner `alone` and is
        // near its S; the other holds the other two corners and is near their S, which they share.
        corner_cut_off,
        // Three cells, one for each corner. Each is a quadrilateral of the corner, the midpoints of its two edges and
        // the barycentre, and is near the S of the corner.
        three,
        // Two cells, one for each of the corners in `feet`. Each holds the points of T that are nearer to the foot of
        // this corner than to the foot of the other one, and is near the S of this corner.
        nearest_foot
    };
    Kind kind = Kind::one;
    Index near = -1;
    std::size_t alone = 0;
    // The values of a linear function on T at corner `alone` and at the two corners after it.
    std::array<double, 3> ends{};
    // The values of a linear function on T at its three corners. The function is positive where the foot of corner
    // feet[1] is nearer than the foot of corner feet[0].
    std::array<double, 3> nearer{};
    std::array<std::size_t, 2> feet{};
};

// Computes bounds of pieces, and keeps the argument of the last one.
class PieceBounds {
public:
    // Keeps references; `magnitude` is the M of kernel/rounding.h. Counts the distances from points to single
    // triangles, and a bound test for each bound except same_triangle().
    PieceBounds(const Target& target, double magnitude, Counters& counters)
        : target_(target), magnitude_(magnitude), counters_(counters) {}

    // Returns h(T, B) itself, plus rounding, if S1, S2 and S3 are the same triangle (Eq. 6); otherwise infinity.
    double same_triangle(const PieceCorners& corners, int level);

    // Does the same if one of S1, S2, S3 is as near to every corner, up to rounding, as the S of that corner; otherwise
    // returns infinity. Such ties happen if the foot of a corner lies on an edge or a vertex of B: all triangles there
    // are equally near, but only one of them is named S.
    double tied_triangle(const PieceCorners& corners, int level);

    // Returns the distance of a corner to B plus the longer of the two edges at this corner, for the corner where this
    // sum is least (Eq. 9).
    double u1(const PieceCorners& corners, int level);
    // Returns the largest distance of a corner to B plus the covering radius of T (Eq. 11).
    double u2(const PieceCorners& corners, int level);
    // Cuts T into two or three cells, each near the S of its corners, as in Kang et al. 2018 (Eqs. 14, 18).
    double u3(const PieceCorners& corners, int level);
    // Returns the largest distance from a point of T to the nearer of the feet of two corners; tries two pairs of
    // corners and takes the better one (Eq. 19).
    double u4(const PieceCorners& corners, int level);

    // argument() returns the argument of the last bound, unless that bound was infinite. restore() makes an earlier
    // argument the last one again.
    const PieceArgument& argument() const { return argument_; }
    void restore(const PieceArgument& argument) { argument_ = argument; }

    // Returns the least of h(T, S1), h(T, S2), h(T, S3) or, if `fourth` >= 0, h(T, triangle `fourth`)
    // (Zheng et al. 2022).
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
