// Bounds on the rounding errors of computed distances, and functions that widen a computed distance so that it bounds
// the exact one.
//
// Notation: fl(x) is x rounded to the nearest double. u = 2^-53 is the unit roundoff: |fl(x) - x| <= u |x|, unless
// fl(x) underflows or overflows. "Errs by 3u" stands for a relative error of at most 3u, and "errs by 3uM" for an
// absolute error of at most 3 * u * M.
//
// This file covers the distances between points and triangles, and the widenings that most solvers use. A file that
// needs another widening derives it in its own comments; `git grep -l unit_roundoff` lists these files.
#pragma once

#include "algorithms/kernel/geometry.h"
#include "algorithms/kernel/watched.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

namespace hausbench {

inline constexpr double unit_roundoff = 0x1p-53;

// Returns the next larger double, like std::nextafter towards +infinity, but inlined.
inline double next_up(double x) {
    if (x == 0) return std::numeric_limits<double>::denorm_min();
    if (!(x < std::numeric_limits<double>::infinity())) return x;
    return std::bit_cast<double>(std::bit_cast<std::int64_t>(x) + (x > 0 ? 1 : -1));
}
inline double next_down(double x) { return -next_up(-x); }

// --- point to point -------------------------------------------------------------------------------------------------
//
// For points a and b, let d = |a - b| be the exact distance, s the computed squared distance, and f its root:
//     s = fl(((ax-bx)^2 + (ay-by)^2) + (az-bz)^2),   f = fl(sqrt(s)).
// Each difference has a rounding factor between 1 - u and 1 + u. Its square has two such factors from the difference
// and one of its own, and the two sums add at most two more. So s lies in d^2 [(1-u)^5, (1+u)^5]. The root halves the
// exponent and adds one factor: f lies in d [(1-u)^3.5, (1+u)^3.5]. As 1/(1-u)^3.5 < 1 + 4u and
// 1/(1+u)^3.5 > 1 - 4u, d lies in [f (1 - 4u), f (1 + 4u)].
// The products with 1 - 4u and 1 + 4u are rounded once more; next_down and next_up absorb this error.
// A minimum or maximum of several s is one of them, without further rounding, so the same bounds hold for the
// Hausdorff distance.
//
// Overflow does not occur while |coordinate| <= 2^400: differences are at most 2^401, squares 2^802.
//
// Underflow: a difference that underflows is exact. Let every nonzero |coordinate| be at least 2^-450. Then all
// coordinates are multiples of 2^-502, unequal ones differ by 2^-502 or more, and nonzero squares are at least 2^-1004.
// These are normal numbers, and s = 0 only for equal points. With smaller coordinates, each of the three squares is off
// by at most 2^-1075, their sum by less than 2^-1072, and f by less than 2^-536: bounds are then widened by 2^-500, in
// addition to the relative error.
inline constexpr double largest_safe_coordinate = 0x1p400;
inline constexpr double smallest_safe_coordinate = 0x1p-450;

// Returns the smallest nonzero |coordinate|, or infinity if all are 0. O(n).
inline double smallest_nonzero(const Points& points) {
    double smallest = std::numeric_limits<double>::infinity();
    for (const double value : std::span(points.data(), static_cast<std::size_t>(points.size()))) {
        if (value != 0 && std::abs(value) < smallest) smallest = std::abs(value);
    }
    return smallest;
}

// Returns a lower bound on the exact distance between two points, given their squared distance as computed. Pass
// may_underflow = true if some nonzero |coordinate| may be below smallest_safe_coordinate.
inline double distance_at_least(double squared, bool may_underflow) {
    const double f = std::sqrt(squared);
    if (f == 0) return 0;
    const double low =
        WATCHED_ELSE(
            "distance_at_least: the rounding of the product",
            next_down(f * (1 - WATCHED("distance_at_least: the rounding error of the distance", 4 * unit_roundoff))),
            f * (1 - 4 * unit_roundoff)) -
        WATCHED("distance_at_least: underflow", may_underflow ? 0x1p-500 : 0);
    return low > 0 ? low : 0;
}

// Returns an upper bound on the exact distance between two points, given their squared distance as computed. For
// `may_underflow`, see distance_at_least().
inline double distance_at_most(double squared, bool may_underflow) {
    const double f = std::sqrt(squared);
    const double high =
        f == 0
            ? 0
            : WATCHED_ELSE(
                  "distance_at_most: the rounding of the product",
                  next_up(f * (1 + WATCHED("distance_at_most: the rounding error of the distance", 4 * unit_roundoff))),
                  f * (1 + 4 * unit_roundoff));
    return may_underflow ? WATCHED_ELSE("distance_at_most: underflow", next_up(high + 0x1p-500), high) : high;
}

// --- point to triangle, and subdivided triangles ---------------------------------------------------------------------
//
// Limits on M, the largest |coordinate| of the target B and of the source A, moved by its pose. Solvers require that M
// is 0 or between these limits, so that nothing overflows and underflow is negligible.
inline constexpr double smallest_safe_magnitude = 0x1p-400, largest_safe_magnitude = largest_safe_coordinate;

// Levels. Solvers cut the triangles of A into pieces, which are smaller triangles, and rounding moves the corners of
// the pieces off A. A computed point has *level* k if it is within 2k * uM of the exact point of A that it stands for.
// The vertices of A have level 0, and each halving of an edge adds one, because the midpoint fl((a + b) / 2) errs by at
// most u |a + b| / 2 <= uM in each coordinate, so by at most sqrt(3) * uM < 2uM in length, and inherits at most the
// larger of the errors of a and b.
//
// Returns an upper bound on the distance to B of the exact point of A that a computed point of this level stands for.
// `squared` is the squared distance of the computed point to B, according to closest_point (point_triangle.h);
// `magnitude` is M. For a piece, pass the largest squared distance in the computed piece: the result then holds in the
// exact piece, and the exact pieces of a triangle cover it.
//
// The parts of the bound:
//   - Level 0: closest_point returns a point within 7uM of a triangle of B, at the computed squared distance s. This s
//     errs as derived above; its underflow part, 2^-536, is far below uM. So sqrt(s) (1 + 4u) + 8uM bounds the exact
//     distance d: 7uM are needed for the point, and the eighth uM is left for the losses below.
//   - Level k: the distance to B changes no more than the point moves, so 2k * uM is added.
//   - Rounding the sum, which needs no next_up. To first order, this costs at most u (d + 8uM), with
//     d <= 2 sqrt(3) M < 3.5M. The result of distance_at_most is at least (1 + 0.9u) d: it uses 4u, of which only 3.5u
//     are needed, and its next_up adds at least 0.4u more than the product loses by rounding. The other
//     0.1u d < 0.4uM come from the eighth uM. Underflow uses at most a 2^-83 part of that uM.
inline double surface_distance_at_most(double squared, double magnitude, int level) {
    if (magnitude == 0) return 0;
    return distance_at_most(squared, false) +
           WATCHED_ELSE("surface_distance_at_most: the error of the closest point",
                        (WATCHED_ELSE("surface_distance_at_most: underflow and the rounding of the sum",
                                      WATCHED("surface_distance_at_most: the error of the kernel", 8), 7) +
                         WATCHED("surface_distance_at_most: the error of the midpoints", 2 * level)) *
                            unit_roundoff * magnitude,
                        0);
}

// The level of a point that closest_point() returned for a triangle of A. A point of level k is within 2k * u * M of A,
// where u is the unit roundoff and M the largest |coordinate|. The point is within 7uM, so level 4 is enough.
inline constexpr int level_of_closest_point = 4;

// The level of a point computed as fl(fl((1 - t) a) + fl(t b)), with 0 <= t <= 1, for an edge ab, or as
// fl((a + b + c) / 3) for a triangle abc. Each coordinate of either errs by at most 3uM:
//   - In the first, the rounding of 1 - t costs at most uM, the two products uM in total, and their sum uM.
//   - In the second, the sum a + b errs by 2uM, and adding c by 3uM. A third of these 5uM, and uM for the division,
//     make less than 3uM.
// In length, this is at most sqrt(3) * 3uM < 6uM = 2 * 3uM, so level 3 is enough.
inline const int level_of_inner_point = WATCHED_ELSE("rounding: an inner point is off its piece", 3, 0);

// Returns the point a + t * (b - a) of the edge ab, for 0 <= t <= 1.
//
// Error, with the unit roundoff u, the largest |coordinate| M of the mesh, and the largest |coordinate| e of b - a: in
// each coordinate, b - a errs by at most u e, its product with t by as much again, and the sum by uM. Together this is
// at most uM + 2.01u e. (A point of level k errs by at most 2k * uM in length.)
//   - In general, e <= 2M, so this is at most 5.1uM, and sqrt(3) * 5.1uM < 10uM = 2 * 5uM: level 5.
//   - If e <= M / 16, it is at most 1.13uM, and sqrt(3) * 1.13uM < 2uM: level 1.
// If M = 0, the result is exact.
inline Vec3 point_of_edge(const Vec3& a, const Vec3& b, double t) { return a + t * (b - a); }

inline constexpr int level_of_long_edge = 5;

// Returns the level of a point from point_of_edge(): 1 for short edges, 5 for long ones. `longest` is the computed
// largest |coordinate| of b - a, or the largest one of several edges. Its rounding error, a factor of 1 - u, does not
// matter, because the derivation at point_of_edge() has slack for it.
inline int level_of_point_of_edge(double longest, double magnitude) {
    return longest <= magnitude / 16 ? 1 : WATCHED_ELSE("rounding: a point of a long edge", level_of_long_edge, 1);
}

// Returns an upper bound on the exact sum of two lengths f and g, given their computed sum. f is the distance to B of a
// point of A with this level, as closest_point computes it, or the largest of several such distances. g is the computed
// distance between two points of A, or more.
//
// f and g each err by 3.5u, and rounding their sum adds u: the factor 1 + 5u is enough for these. The closest point is
// off B by up to 7uM, and underflow is far below the eighth uM. Level k adds 2k * uM, as above. Each next_up absorbs
// the rounding error of the product or the sum before it.
inline double surface_sum_at_most(double sum, double magnitude, int level) {
    if (magnitude == 0) return 0;
    return WATCHED_ELSE(
        "rounding: a sum of two lengths is rounded up",
        next_up(
            WATCHED_ELSE("rounding: the product in a sum of two lengths is rounded up",
                         next_up(sum * (1 + WATCHED("rounding: a sum of two lengths is widened", 5 * unit_roundoff))),
                         sum * (1 + 5 * unit_roundoff)) +
            (WATCHED("rounding: a sum of two lengths is widened by uM", 8) +
             WATCHED("rounding: a sum of two lengths is widened by its level", 2 * level)) *
                unit_roundoff * magnitude),
        next_up(sum * (1 + 5 * unit_roundoff)) + (8 + 2 * level) * unit_roundoff * magnitude);
}

// Returns a lower bound on the distance of an exact point of A from B. `certified` is a lower bound for the computed
// point that stands for the exact one; the two are at most 2 * level * u * magnitude apart, where u is the unit
// roundoff.
inline double surface_distance_at_least(double certified, double magnitude, int level) {
    const double low =
        level == 0 ? certified
                   : WATCHED_ELSE("surface_distance_at_least: the rounding of the difference",
                                  next_down(certified - WATCHED("surface_distance_at_least: the error of the midpoints",
                                                                2 * level * unit_roundoff * magnitude)),
                                  certified - 2 * level * unit_roundoff * magnitude);
    return low > 0 ? low : 0;
}

// --- samples of a triangle -------------------------------------------------------------------------------------------
//
// The grid of n steps on a triangle abc (grid_point()) consists of the points (i a + j b + k c) / n with integers i, j,
// k >= 0 and i + j + k = n. It cuts the triangle into n^2 small ones, whose edges are 1/n as long.
//
// grid_point() returns a point within 7uM of the exact one, for n < 2^53. The three products err by
// u (i + j + k) M = u n M in total, and each of the two sums by as much; divided by n, these are 3uM. The division
// adds uM. Together this is 4uM in each coordinate, plus terms of order u^2, and sqrt(3) * 4uM < 7uM. Underflow costs
// far less.
inline Vec3 grid_point(const Vec3& a, const Vec3& b, const Vec3& c, std::int64_t i, std::int64_t j, std::int64_t n) {
    return ((static_cast<double>(i) * a + static_cast<double>(j) * b) + static_cast<double>(n - i - j) * c) /
           static_cast<double>(n);
}

// The level of a grid point. A point of level k is within 2k * u * M of A, where u is the unit roundoff and M the
// largest |coordinate|. Grid points are within 7uM, so level 4 is enough.
inline const int level_of_grid_point = WATCHED_ELSE("grid: the rounding of its points", 4, 3);

// Covering radius: every point p of a triangle is within L / sqrt(3) of a corner, where L is the length of the longest
// edge. Let c_i be the corners and p = sum w_i c_i, with weights w_i >= 0 that add up to 1. The smallest |c_i - p|^2 is
// at most their weighted mean. As sum w_i (c_i - p) = 0,
//     min |c_i - p|^2 <= sum w_i |c_i - p|^2 = sum_{i<j} w_i w_j |c_i - c_j|^2 <= L^2 (1 - sum w_i^2) / 2 <= L^2 / 3.
// This holds for a triangle of any shape, even if all corners lie on a line or coincide; for a regular triangle, the
// centre attains it.
//
// Returns an upper bound on the distance to B of any point of a triangle. `at_samples` is the largest
// surface_distance_at_most of the points of its grid of n steps, so it is 0 only if M is 0; `squared_edge` is L^2 as
// computed. The bound is at_samples + r: each small triangle of the grid has edges of length L / n or less, so every
// point of the triangle is within r = L / (n sqrt(3)) of a point of the grid, and the distance to B changes no more
// than the point moves.
//
// fl(sqrt(L^2)) errs by 3.5u (see "point to point"), fl(sqrt(3)) by 0.6u, and product and quotient by u each: to first
// order, r is at most (1 + 6.1u) times the computed quotient. The product with 1 + 8u loses at most u by rounding. The
// next_up absorbs the rounding error of the sum, and half an ulp is left over. It is at least 2^-504, because
// at_samples >= 8uM >= 2^-450. That is more than the 2^-536 by which L may be too small because of underflow.
inline double grid_distance_at_most(double at_samples, double squared_edge, std::int64_t n) {
    if (at_samples == 0) return 0;
    const double root_of_three = WATCHED_ELSE("grid: the factor of its radius", 0x1.bb67ae8584caap+0, 2);
    const double radius = std::sqrt(squared_edge) / (static_cast<double>(n) * root_of_three);
    return WATCHED_ELSE(
        "grid: the rounding of the sum",
        next_up(at_samples + radius * (1 + WATCHED("grid: the rounding of its radius", 8 * unit_roundoff))),
        at_samples + radius * (1 + 8 * unit_roundoff));
}

// Computes upper bounds on distances in one scene, whose largest |coordinate| is `magnitude`. If `certify` is false,
// distances are not widened for rounding errors; this shows the cost of widening, and what goes wrong without it.
struct SurfaceRounding {
    double magnitude;
    bool certify = true;

    double at_most(double squared, int level) const {
        return certify ? surface_distance_at_most(squared, magnitude, level) : std::sqrt(squared);
    }
};

}  // namespace hausbench
