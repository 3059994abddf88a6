// Tolerances that are fractions of a shape, as lengths.
#pragma once

#include "algorithms/solver.h"

#include <string>
#include <vector>

namespace hausbench {

// Units of a tolerance: the diagonal or the longest side of the bounding box of A, a plain length, or the lower bound.
inline const std::vector<std::string> tolerance_units = {"diagonal", "longest", "absolute", "lower"};

// Returns the length of one unit of a tolerance; 1 for `absolute` and `lower`. `diagonal` and `longest_side` are
// measured on the bounding box of A as loaded, whatever the pose, and also for h(B,A).
double unit_of(const std::string& of, double diagonal, double longest_side);

// Returns the diagonal of the bounding box of both point sets together.
double diagonal_of_both(const Points& a, const Points& b);

// Returns tolerance * unit, clamped to a finite length above 0.
double tolerance_as_length(double tolerance, double unit);

// Default time limit of the question whether a distance is above a length. If they are very close, it may never be
// decided.
inline constexpr double question_seconds = 10;

// A tolerance as a length, or as a fraction of the lower bound, and where it comes from.
struct ResolvedTolerance {
    Tolerance tolerance;
    std::string of;          // the unit that counts: one of tolerance_units, or `diagonal of both`
    double unit = 1;         // its length; 1 for `absolute` and `lower`
    bool fell_back = false;  // the requested unit has no length
};

// Returns the tolerance for shapes with these points. A default tolerance must be meaningful for every input: if the
// box of A has no extent, it is a fraction of `extent`, the diagonal of the box of both shapes. If they have no extent
// either, it is a length.
ResolvedTolerance resolve_tolerance(double tolerance, const std::string& of, const Points& a, double extent);

}  // namespace hausbench
