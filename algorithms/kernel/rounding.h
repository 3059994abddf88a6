// What rounding may do to the distances computed here, and how bounds are widened so that they hold all the same.
//
// u = 2^-53, round to nearest. The distances between points and triangles, and the widenings that most solvers use, are here. A file that
// widens by more of its own derives it at the place: `git grep -l unit_roundoff` finds them.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

namespace hausbench {

inline constexpr double unit_roundoff = 0x1p-53;

// As std::nextafter towards +infinity, but inlined.
inline double next_up(double x) {
    if (x == 0) return std::numeric_limits<double>::denorm_min();
    if (!(x < std::numeric_limits<double>::infinity())) return x;
    return std::bit_cast<double>(std::bit_cast<std::int64_t>(x) + (x > 0 ? 1 : -1));
}
inline double next_down(double x) { return -next_up(-x); }

// --- point to point -------------------------------------------------------------------------------------------------
//
// s = fl(((ax-bx)^2 + (ay-by)^2) + (az-bz)^2), f = fl(sqrt(s)), d = |a - b|.
// A difference has one relative error of at most u, its square two of them and one more, the sums at most two more, so
// s lies in d^2 [(1-u)^5, (1+u)^5] and f in d [(1-u)^3.5, (1+u)^3.5]. As 1/(1-u)^3.5 < 1 + 4u and 1/(1+u)^3.5 > 1 - 4u,
// d lies in [f (1 - 4u), f (1 + 4u)]. Minima and maxima of s are exact choices among such values, so the same holds of
// the Hausdorff distance. The products with 1 -+ 4u are rounded once more, which next_up and next_down make up for.
//
// Overflow: none while |coordinate| <= 2^400 (differences 2^401, squares 2^802).
// Underflow: differences are exact when they underflow. If every nonzero |coordinate| >= 2^-450, all coordinates are
// multiples of 2^-502, unequal ones differ by 2^-502 or more, and squares are at least 2^-1004: normal, and s = 0 only
// for equal points. Otherwise each of three squares is off by 2^-1075 at most, their sum by less than 2^-1072, and f by
// less than 2^-536: widen by 2^-500 beyond the relative error.
inline constexpr double largest_safe_coordinate = 0x1p400;
inline constexpr double smallest_safe_coordinate = 0x1p-450;

// Smallest nonzero |coordinate|, infinity where there is none. O(n).
inline double smallest_nonzero(const Points& points) {
    double smallest = std::numeric_limits<double>::infinity();
    for (const double value : std::span(points.data(), static_cast<std::size_t>(points.size()))) {
        if (value != 0 && std::abs(value) < smallest) smallest = std::abs(value);
    }
    return smallest;
}

inline double distance_at_least(double squared, bool may_underflow) {
    const double f = std::sqrt(squared);
    if (f == 0) return 0;
    const double low = next_down(f * (1 - 4 * unit_roundoff)) - (may_underflow ? 0x1p-500 : 0);
    return low > 0 ? low : 0;
}

inline double distance_at_most(double squared, bool may_underflow) {
    const double f = std::sqrt(squared);
    const double high = f == 0 ? 0 : next_up(f * (1 + 4 * unit_roundoff));
    return may_underflow ? next_up(high + 0x1p-500) : high;
}

// --- point to triangle, and subdivided triangles ---------------------------------------------------------------------
//
// M = max |coordinate| of A posed and B, either 0 or between these two.
inline constexpr double smallest_safe_magnitude = 0x1p-400, largest_safe_magnitude = largest_safe_coordinate;

// closest_point (point_triangle.h) returns a point within 7uM of the triangle, at the computed squared distance s, which
// errs as above; the underflow part, 2^-536, is far below uM. So sqrt(s) (1 + 4u) + 8uM bounds the exact distance.
// The sum needs no next_up. Rounding it costs u (d + 8uM) at most, in first order, with d <= 2 sqrt(3) M < 3.5M.
// distance_at_most is at least (1 + 0.9u) d: it uses 4u where 3.5u are needed, and its next_up adds 0.4u more than rounding
// the product takes. The other 0.1ud < 0.4uM come from the eighth uM, of which underflow uses 2^-83 at most.
//
// A midpoint fl((a + b) / 2) errs by u |a + b| / 2 <= uM in each coordinate, below 2uM in length, and inherits no more
// than the larger error of its ends: a vertex after k halvings is within 2kuM of the exact one. The exact pieces cover the
// triangle, and the distance changes no more than the point moves.
inline double surface_distance_at_most(double squared, double magnitude, int level) {
    if (magnitude == 0) return 0;
    return distance_at_most(squared, false) + (8 + 2 * level) * unit_roundoff * magnitude;
}

// A point of A that closest_point returned is within 7uM of A: closer than a vertex after four halvings.
inline constexpr int level_of_closest_point = 4;

// fl(fl((1 - t) a) + fl(t b)) with 0 <= t <= 1 is within 6uM of the edge ab, and fl((a + b + c) / 3) of the triangle abc, so like a
// vertex after three halvings. In each coordinate: 1 - t errs by u, the products by u M in all, their sum by uM, together 3uM;
// the sums a + b and + c err by 2uM and 3uM, a third of that and uM for the division make less than 3uM; sqrt(3) 3 < 6.
inline constexpr int level_of_inner_point = 3;

// A point of the edge ab, 0 <= t <= 1. b - a errs by u |b - a| in each coordinate, its product with t by the same
// amount, the sum by uM: uM + 2.01u e together, where e is the largest |coordinate| of b - a. That is at most 5.1uM,
// because e <= 2M, and sqrt(3) 5.1 < 10: like a vertex after five halvings. If e <= M / 16 it is 1.13uM, and sqrt(3)
// 1.13 < 2: like a vertex after one halving. M = 0: nothing errs.
inline Vec3 point_of_edge(const Vec3& a, const Vec3& b, double t) { return a + t * (b - a); }

inline constexpr int level_of_long_edge = 5;

// `longest`: the largest e as computed, which may be u of it too small; the 1.13 above has room for that.
inline int level_of_point_of_edge(double longest, double magnitude) {
    return longest <= magnitude / 16 ? 1 : level_of_long_edge;
}

// `sum` = fl(f + g). f is the distance of a point of A to B as closest_point computes it, or the largest of several,
// and g is a length between points of A, computed in the same way, or an upper bound of it. f and g err by 3.5u and
// their sum rounds by u; 1 + 5u makes up for these. The point of B is off it by 7uM, and underflow is far below the
// eighth uM. Each next_up gives back the rounding of the product or sum before it.
inline double surface_sum_at_most(double sum, double magnitude, int level) {
    if (magnitude == 0) return 0;
    return next_up(next_up(sum * (1 + 5 * unit_roundoff)) + (8 + 2 * level) * unit_roundoff * magnitude);
}

// A certified distance of the rounded vertex becomes one of the exact point of A that it stands for.
inline double surface_distance_at_least(double certified, double magnitude, int level) {
    const double low = level == 0 ? certified : next_down(certified - 2 * level * unit_roundoff * magnitude);
    return low > 0 ? low : 0;
}

// --- samples of a triangle -------------------------------------------------------------------------------------------
//
// The grid of n steps on a triangle: the points (i a + j b + k c) / n with integers i, j, k >= 0 and i + j + k = n.
// It cuts the triangle into n^2 small ones, whose edges are 1/n as long.
//
// Computed as below, a point of the grid is within 7uM of the exact one, for n < 2^53: products cost u (i + j + k) M = u n M in all,
// either sum as much, the quotient uM: 4uM in each coordinate and terms of order u^2, and sqrt(3) 4 < 7. Underflow costs far less.
inline Vec3 grid_point(const Vec3& a, const Vec3& b, const Vec3& c, std::int64_t i, std::int64_t j, std::int64_t n) {
    return ((static_cast<double>(i) * a + static_cast<double>(j) * b) + static_cast<double>(n - i - j) * c) /
           static_cast<double>(n);
}

// Closer to A than a vertex after four halvings.
inline constexpr int level_of_grid_point = 4;

// Covering radius: every point p of a triangle is within L / sqrt(3) of a corner, where L is its longest edge. Let p
// = sum w_i c_i, with weights w_i >= 0 that add up to 1. Since sum w_i (c_i - p) = 0, min |c_i - p|^2 <= sum w_i |c_i
// - p|^2 = sum_{i<j} w_i w_j |c_i - c_j|^2 <= L^2 (1 - sum w_i^2) / 2 <= L^2 / 3. The shape does not matter: a needle
// or a point will do; a regular triangle attains the bound at its centre. So every point of the triangle is within r
// = L / (n sqrt(3)) of a grid of n steps. The distance to B changes by no more than the point moves, so it is at most
// r larger than at a sample.
//
// `at_samples` is the largest surface_distance_at_most of the samples, so 0 only where M is 0; `squared_edge` is L^2 as computed.
// fl(sqrt(L^2)) errs by 3.5u (see point to point), fl(sqrt(3)) by 0.6u, product and quotient by u each: r is at most (1 + 6.1u)
// times the quotient, in first order. The product with 1 + 8u loses u at most. next_up makes up for rounding the sum, and half an
// ulp is left: at least 2^-504, for at_samples >= 8uM >= 2^-450. That is more than underflow takes from L, 2^-536.
inline double grid_distance_at_most(double at_samples, double squared_edge, std::int64_t n) {
    if (at_samples == 0) return 0;
    const double root_of_three = 0x1.bb67ae8584caap+0;
    const double radius = std::sqrt(squared_edge) / (static_cast<double>(n) * root_of_three);
    return next_up(at_samples + radius * (1 + 8 * unit_roundoff));
}

// The upper bound for one scene. Switching `certify` off leaves the widening out, to measure its cost and to show the
// errors without it.
struct SurfaceRounding {
    double magnitude;
    bool certify = true;

    double at_most(double squared, int level) const {
        return certify ? surface_distance_at_most(squared, magnitude, level) : std::sqrt(squared);
    }
};

}  // namespace hausbench
