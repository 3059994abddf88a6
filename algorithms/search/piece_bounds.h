// Upper bounds of h(T, B) for a piece T of a triangle of A, from its corners v1, v2, v3, their distances to B and the triangles
// S1, S2, S3 of B nearest to them. Sacht and Jacobson 2024, section 3.2, names the four that its cascade tries u1 to u4.
//
// They rest on two facts. The distance to a convex set (a triangle, a point) is convex, so over a polygon it is largest at a
// corner. And cutting T anywhere covers it all the same: where exactly a piece is cut makes a bound tight, never right or wrong.
// So rounding matters only in the lengths that are added or compared, and in how far a computed point is from T.
//
// Each bound holds for the exact piece that stands behind one whose corners were rounded `level` times (kernel/rounding.h).
#pragma once

#include "algorithms/kernel/rounding.h"
#include "algorithms/search/target.h"

#include <array>
#include <limits>
#include <optional>

namespace hausbench {

using PieceCorners = std::array<MeasuredPoint, 3>;

// g: no point of the triangle is farther than this from the nearest corner. The circumradius of an acute triangle, half of the
// longest edge of any other.
double covering_radius_at_most(const std::array<Vec3, 3>& corners);

// The barycentre, within level_of_inner_point of the piece.
inline Vec3 barycentre(const PieceCorners& v) { return (v[0].point + v[1].point + v[2].point) / 3.0; }

// Why a bound holds: the piece, cut into cells, each near one triangle of B.
struct PieceArgument {
    enum class Kind {
        // All of it is near triangle `near`.
        one,
        // A cell for each corner, of the points nearest to it, against its S.
        nearest_corner,
        // Corner `alone` is cut off at `ends`, against its S; the rest against the other two S.
        corner_cut_off,
        // Three quadrilaterals: a corner, the midpoints beside it, the barycentre; against its S.
        three,
        // Two cells: the points nearest to the closest point of one of two corners; against its S.
        nearest_foot
    };
    Kind kind = Kind::one;
    Index near = -1;
    std::size_t alone = 0;
    // A function at corner `alone` and at the two after it, zero where the piece is cut: it is linear along the edges.
    std::array<double, 3> ends{};
    // At each corner, positive where the foot of the second of `feet` is nearer. It is linear too.
    std::array<double, 3> nearer{};
    std::array<std::size_t, 2> feet{};
};

class PieceBounds {
public:
    // Both are kept; `magnitude` as in kernel/rounding.h. Distances to single triangles are counted, and every bound as a test.
    PieceBounds(const Target& target, double magnitude, Counters& counters)
        : target_(target), magnitude_(magnitude), counters_(counters) {}

    // Exact where one triangle of B is named nearest to all three corners (Eq. 6); infinite otherwise.
    double same_triangle(const PieceCorners& corners, int level);

    // The same where some S_i is as near to all three as any, but ties named others: at shared edges and vertices of B.
    double tied_triangle(const PieceCorners& corners, int level);

    // A corner's distance and its longest edge (Eq. 9).
    double u1(const PieceCorners& corners, int level);
    // Largest corner distance and covering_radius (Eq. 11).
    double u2(const PieceCorners& corners, int level);
    // Kang et al. 2018: cut in two or three, each against its S (Eqs. 14, 18).
    double u3(const PieceCorners& corners, int level);
    // Pairs of the corners' closest points (Eq. 19).
    double u4(const PieceCorners& corners, int level);

    // The argument of the bound that was computed last, unless that bound was infinite.
    const PieceArgument& argument() const { return argument_; }
    void restore(const PieceArgument& argument) { argument_ = argument; }

    // Zheng et al. 2022: the least of the h(T, S_i), and for `fourth` >= 0 of h(T, that triangle).
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
