// Rounding errors of the distances computed here, and how bounds are widened so that they still hold.
//
// u = 2^-53, round to nearest. This file covers the distances between points and triangles and the widenings that
// most solvers use. A file that widens by something else derives it there: `git grep -l unit_roundoff` lists these
// files.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

namespace hausbench {

inline constexpr double unit_roundoff = 0x1p-53;

// Like std::nextafter towards +infinity, but inlined.
inline double next_up(double x) {
    if (x == 0) return std::numeric_limits<double>::denorm_min();
    if (!(x < std::numeric_limits<double>::infinity())) return x;
    return std::bit_cast<double>(std::bit_cast<std::int64_t>(x) + (x > 0 ? 1 : -1));
}
inline double next_down(double x) { return -next_up(-x); }

// --- point to point -------------------------------------------------------------------------------------------------
//
// s = fl(((ax-bx)^2 + (ay-by)^2) + (az-bz)^2), f = fl(sqrt(s)), d = |a - b|.
// A difference has one relative error of at most u, its square has two of them and one more, and the sums add at
// most two more, so s lies in d^2 [(1-u)^5, (1+u)^5] and f in d [(1-u)^3.5, (1+u)^3.5]. As 1/(1-u)^3.5 < 1 + 4u and
// 1/(1+u)^3.5 > 1 - 4u, d lies in [f (1 - 4u), f (1 + 4u)]. Minima and maxima of s are exact choices among such
// values, so the same holds for the Hausdorff distance. The products with 1 -+ 4u are rounded once more; next_up
// and next_down make up for that.
//
// Overflow: none while |coordinate| <= 2^400 (differences 2^401, squares 2^802).
// Underflow: differences are exact when they underflow. If every nonzero |coordinate| >= 2^-450, all coordinates
// are multiples of 2^-502, unequal ones differ by 2^-502 or more, and squares are at least 2^-1004: these are
// normal, and s = 0 only for equal points. Otherwise each of the three squares is off by at most 2^-1075, their sum
// by less than 2^-1072, and f by less than 2^-536: bounds are widened by 2^-500 beyond the relative error.
inline constexpr double largest_safe_coordinate = 0x1p400;
inline constexpr double smallest_safe_coordinate = 0x1p-450;

// Returns the smallest nonzero |coordinate|, or infinity if there is none. O(n).
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
// M = max |coordinate| of A posed and B; it is either 0 or between these two values.
inline constexpr double smallest_safe_magnitude = 0x1p-400, largest_safe_magnitude = largest_safe_coordinate;

// closest_point (point_triangle.h) returns a point within 7uM of the triangle, at the computed squared distance s,
// which errs as above; its underflow part, 2^-536, is far below uM. So sqrt(s) (1 + 4u) + 8uM bounds the exact
// distance.
// The sum needs no next_up. To first order, rounding it costs at most u (d + 8uM), with d <= 2 sqrt(3) M < 3.5M.
// distance_at_most is at least (1 + 0.9u) d: it uses 4u where 3.5u are needed, and its next_up adds 0.4u more than
// the product loses by rounding. The other 0.1ud < 0.4uM come from the eighth uM, of which underflow uses at most a
// 2^-83 part.
//
// A midpoint fl((a + b) / 2) errs by u |a + b| / 2 <= uM in each coordinate, so by less than 2uM in length, and
// inherits at most the larger error of its ends: a vertex after k halvings is within 2kuM of the exact one. The
// exact pieces cover the triangle, and the distance changes no more than the point moves.
inline double surface_distance_at_most(double squared, double magnitude, int level) {
    if (magnitude == 0) return 0;
    return distance_at_most(squared, false) + (8 + 2 * level) * unit_roundoff * magnitude;
}

// A point of A that closest_point returned is within 7uM of A: closer than a vertex after four halvings.
inline constexpr int level_of_closest_point = 4;

// fl(fl((1 - t) a) + fl(t b)) with 0 <= t <= 1 is within 6uM of the edge ab, and fl((a + b + c) / 3) is within 6uM
// of the triangle abc: both like a vertex after three halvings. In each coordinate of the first, 1 - t errs by u,
// the products by uM in total, and their sum by uM: together 3uM. In the second, the sums a + b and + c err by 2uM
// and 3uM; a third of that and uM for the division make less than 3uM. sqrt(3) 3 < 6.
inline constexpr int level_of_inner_point = 3;

// Returns a point of the edge ab, for 0 <= t <= 1. b - a errs by u |b - a| in each coordinate, its product with t
// by as much again, and the sum by uM: uM + 2.01u e in total, where e is the largest |coordinate| of b - a. That is
// at most 5.1uM, as e <= 2M, and sqrt(3) 5.1 < 10: like a vertex after five halvings. If e <= M / 16, it is at most
// 1.13uM, and sqrt(3) 1.13 < 2: like a vertex after one halving. If M = 0, nothing errs.
inline Vec3 point_of_edge(const Vec3& a, const Vec3& b, double t) { return a + t * (b - a); }

inline constexpr int level_of_long_edge = 5;

// `longest` is the largest e as computed. It may be too small by a factor of 1 - u; the 1.13 above has room for
// that.
inline int level_of_point_of_edge(double longest, double magnitude) {
    return longest <= magnitude / 16 ? 1 : level_of_long_edge;
}

// Returns an upper bound of the exact f + g, given `sum` = fl(f + g). f is the distance from a point of A to B as
// closest_point computes it, or the largest of several such distances. g is a length between points of A, computed
// in the same way, or more than that length. f and g err by 3.5u, and their sum rounds by u: 1 + 5u covers these.
// The point of B is off B by up to 7uM, and underflow is far below the eighth uM. Each next_up makes up for
// rounding the product or the sum before it.
inline double surface_sum_at_most(double sum, double magnitude, int level) {
    if (magnitude == 0) return 0;
    return next_up(next_up(sum * (1 + 5 * unit_roundoff)) + (8 + 2 * level) * unit_roundoff * magnitude);
}

// Turns a certified distance of a rounded vertex into a certified distance of the exact point of A that it stands
// for.
inline double surface_distance_at_least(double certified, double magnitude, int level) {
    const double low = level == 0 ? certified : next_down(certified - 2 * level * unit_roundoff * magnitude);
    return low > 0 ? low : 0;
}

// --- samples of a triangle -------------------------------------------------------------------------------------------
//
// The grid of n steps on a triangle consists of the points (i a + j b + k c) / n with integers i, j, k >= 0 and
// i + j + k = n. It cuts the triangle into n^2 small ones, whose edges are 1/n as long as its own.
//
// grid_point() returns a point within 7uM of the exact one, for n < 2^53: the products cost u (i + j + k) M = u n M
// in total, each of the two sums as much, and the quotient uM: 4uM in each coordinate plus terms of order u^2, and
// sqrt(3) 4 < 7. Underflow costs far less.
inline Vec3 grid_point(const Vec3& a, const Vec3& b, const Vec3& c, std::int64_t i, std::int64_t j, std::int64_t n) {
    return ((static_cast<double>(i) * a + static_cast<double>(j) * b) + static_cast<double>(n - i - j) * c) /
           static_cast<double>(n);
}

// A point of the grid is closer to A than a vertex after four halvings.
inline constexpr int level_of_grid_point = 4;

// Covering radius: every point p of a triangle is within L / sqrt(3) of a corner, where L is its longest edge. Let
// p = sum w_i c_i, with weights w_i >= 0 that add up to 1. As sum w_i (c_i - p) = 0,
//     min |c_i - p|^2 <= sum w_i |c_i - p|^2 = sum_{i<j} w_i w_j |c_i - c_j|^2 <= L^2 (1 - sum w_i^2) / 2 <= L^2 / 3.
// This holds for a triangle of any shape, even a needle or a point; a regular triangle attains it at its centre.
// Every point of the triangle is within r = L / (n sqrt(3)) of a point of the grid of n steps. The distance to B
// changes no more than the point moves, so it exceeds the distance at some sample by at most r.
//
// `at_samples` is the largest surface_distance_at_most of the samples, so it is 0 only if M is 0; `squared_edge` is
// L^2 as computed. fl(sqrt(L^2)) errs by 3.5u (see point to point), fl(sqrt(3)) by 0.6u, and product and quotient
// by u each: r is at most (1 + 6.1u) times the quotient, to first order. The product with 1 + 8u loses at most u.
// next_up makes up for rounding the sum, and half an ulp is left over: at least 2^-504, because
// at_samples >= 8uM >= 2^-450. That is more than the 2^-536 that underflow takes from L.
inline double grid_distance_at_most(double at_samples, double squared_edge, std::int64_t n) {
    if (at_samples == 0) return 0;
    const double root_of_three = 0x1.bb67ae8584caap+0;
    const double radius = std::sqrt(squared_edge) / (static_cast<double>(n) * root_of_three);
    return next_up(at_samples + radius * (1 + 8 * unit_roundoff));
}

// Upper bounds for one scene. If `certify` is off, they are not widened, to measure the cost of widening and to
// show what goes wrong without it.
struct SurfaceRounding {
    double magnitude;
    bool certify = true;

    double at_most(double squared, int level) const {
        return certify ? surface_distance_at_most(squared, magnitude, level) : std::sqrt(squared);
    }
};

}  // namespace hausbench
