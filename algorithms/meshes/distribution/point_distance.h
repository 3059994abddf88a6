// Bounds on the distance between two points: exact for coordinates with few digits, such as voxels. There many
// distances are equal, or equal to the length that a query asks about, and wider bounds would not tell which points
// count.
#pragma once

#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/triangle.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/solver.h"

#include <cmath>

namespace hausbench::distribution {

// Returns whether x - y is a double: whether the rounding error of the subtraction (Knuth) is 0.
inline bool is_exact_difference(double x, double y) {
    const double difference = x - y, back = difference - x;
    return (x - (difference - back)) - (y + back) == 0;
}

// Returns bounds on |a - b|. |Coordinates| must be at most largest_safe_coordinate.
//
// If no step of the sum of squares rounds, the sum s is exact, and so is the sign of root^2 - s, which tells on which
// side of the distance the root lies. Squares of numbers below 2^-480 may underflow and count as rounded; the others
// are multiples of 2^-1064, as are their errors. Otherwise the bounds for a computed sum hold (kernel/rounding.h).
inline Bounds point_distance(const Vec3& a, const Vec3& b) {
    double sum = 0;
    bool exact = true;
    for (int k = 0; k < 3; ++k) {
        const double x = a[k] - b[k], square = x * x;
        exact = exact &&
                WATCHED_ELSE("distribution: a difference that rounds", is_exact_difference(a[k], b[k]), true) &&
                WATCHED_ELSE("distribution: a sum that rounds", is_exact_difference(sum, -square), true) &&
                (x == 0 || (WATCHED_ELSE("distribution: a square that underflows", std::abs(x) >= 0x1p-480, true) &&
                            WATCHED_ELSE("distribution: a square that rounds", std::fma(x, x, -square) == 0, true)));
        sum += square;
    }
    if (!exact) return {distance_at_least(sum, true), distance_at_most(sum, true)};
    const double root = std::sqrt(sum), above = std::fma(root, root, -sum);
    return {above > 0 ? WATCHED_ELSE("distribution: a root above the distance", next_down(root), root) : root,
            above < 0 ? WATCHED_ELSE("distribution: a root below the distance", next_up(root), root) : root};
}

}  // namespace hausbench::distribution
