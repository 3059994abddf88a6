// Upper bounds on h(T, B), the largest distance from a point of T to B, for a piece T of a triangle of A. They are
// computed from the corners of T, their distances to B, and the triangles of B nearest to the corners. Sacht and
// Jacobson 2024, section 3.2, call the four bounds of their cascade u1 to u4; the numbers of equations below are
// theirs.
//
// The bounds rest on two facts. The distance to a convex set (a triangle, a point) is a convex function, so over a
// polygon it is largest at a corner. And however T is cut, its parts cover T: the position of a cut decides how tight a
// bound is, not whether it holds. So rounding matters only in lengths that are added or compared, and in the distance
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

// Returns a length r, rounded upward, such that every point of the triangle is within r of some corner: the
// circumradius if the triangle is acute, otherwise half of the longest edge.
double covering_radius_at_most(const std::array<Vec3, 3>& corners);

// Returns the barycentre. Rounding moves it off the triangle by no more than level_of_inner_point allows
// (kernel/rounding.h).
inline Vec3 barycentre(const PieceCorners& v) { return (v[0].point + v[1].point + v[2].point) / 3.0; }

// The reason why the bound of a piece holds: the piece is cut into *cells*, and each cell is compared with one triangle
// of B.
struct PieceArgument {
    enum class Kind {
        // One cell, the whole piece, compared with triangle `near` of B.
        whole_piece,
        // Three cells, one for each corner. Each holds the points of the piece that are nearest to its corner, and is
        // compared with the triangle of B nearest to this corner.
        nearest_corner,
        // Two cells, separated by the line on which a linear function with the values `ends` is zero: one with corner
        // `alone`, one with the other two corners, which have the same nearest triangle of B. Each is compared with the
        // triangle nearest to its corners.
        corner_cut_off,
        // Three cells, one for each corner: the quadrilateral of the corner, the midpoints of its two edges and the
        // barycentre. Each is compared with the triangle of B nearest to its corner.
        three,
        // Two cells, one for each corner in `feet`. The foot of a corner is the point of B closest to it. Each cell
        // holds the points of the piece that are nearer to its own foot than to the other one, and is compared with the
        // triangle of B that contains its foot.
        nearest_foot
    };
    Kind kind = Kind::whole_piece;
    Index near = -1;
    std::size_t alone = 0;
    // The values of the linear function of corner_cut_off, at corner `alone` and at the two corners after it.
    std::array<double, 3> ends{};
    // The values of a linear function at the corners, for nearest_foot. It is positive where the foot of corner feet[1]
    // is nearer than the foot of corner feet[0].
    std::array<double, 3> nearer{};
    std::array<std::size_t, 2> feet{};
};

// Computes upper bounds on the distance from a piece to B, and keeps the reason why the last bound holds.
class PieceBounds {
public:
    // Keeps references. `magnitude` is the largest |coordinate| of B and of A, moved by its pose. Counts the distances
    // from points to single triangles, and the computed bounds except same_triangle().
    PieceBounds(const Target& target, double magnitude, Counters& counters)
        : target_(target), magnitude_(magnitude), counters_(counters) {}

    // If one triangle of B is nearest to all corners, returns the largest distance of a corner, widened by rounding
    // errors; this bound is tight (Eq. 6). Otherwise returns infinity.
    double same_triangle(const PieceCorners& corners, int level);

    // Like same_triangle(), but accepts ties: one triangle of B must be as near to each corner as the nearest triangle
    // recorded for that corner, up to rounding. Ties happen if the point of B closest to a corner lies on an edge or a
    // vertex of B, where several triangles are equally near.
    double tied_triangle(const PieceCorners& corners, int level);

    // Returns the distance of a corner to B plus the longer of the two edges at this corner, for the corner where this
    // sum is least (Eq. 9).
    double u1(const PieceCorners& corners, int level);
    // Returns the largest distance of a corner to B plus the radius of covering_radius_at_most() (Eq. 11).
    double u2(const PieceCorners& corners, int level);
    // Cuts the piece into two or three cells, and returns the largest distance from a cell to the triangle of B nearest
    // to its corners, as in Kang et al. 2018 (Eqs. 14, 18).
    double u3(const PieceCorners& corners, int level);
    // Takes two corners and the points of B closest to them. Returns the largest distance from a point of the piece to
    // the nearer of these two points. Tries two pairs of corners and returns the smaller bound (Eq. 19).
    double u4(const PieceCorners& corners, int level);

    // argument() returns why the last bound holds; it has no meaning if that bound was infinite. restore() puts back an
    // earlier argument.
    const PieceArgument& argument() const { return argument_; }
    void restore(const PieceArgument& argument) { argument_ = argument; }

    // Returns the largest distance from a point of the piece to one triangle of B: to triangle `fourth` or, if that is
    // -1, to the best of the triangles nearest to the corners (Zheng et al. 2022).
    double nearest_triangles(const PieceCorners& corners, int level, Index fourth = -1);

private:
    double at_most(double squared, int level) const { return surface_distance_at_most(squared, magnitude_, level); }
    double squared_to_triangle(const PieceCorners& corners, Index triangle);
    double in_two(const PieceCorners& corners, std::size_t alone);
    double in_three(const PieceCorners& corners, double& whole, Index& near);
    void by_one(Index near) {
        argument_.kind = PieceArgument::Kind::whole_piece;
        argument_.near = near;
    }
    BlockFeet distances(const std::array<Vec3, 7>& points, std::size_t count, Index triangle);

    const Target& target_;
    double magnitude_;
    Counters& counters_;
    PieceArgument argument_;
};

}  // namespace hausbench
