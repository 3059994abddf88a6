// Proves or refutes upper bounds on distances between point sets. Used for reference answers, whose proof must be
// independent of the solvers.
#pragma once

#include "harness/check/verify_exact.h"

namespace hausbench {

struct UpperCheck {
    Quantity quantity = Quantity::directed;
    double upper = 0;
    double seconds = std::numeric_limits<double>::infinity();  // time limit for each direction

    // Returns whether each point of A (for H, also each point of B) has a point of the other set at most `upper` away.
    // Exact rationals decide if interval arithmetic cannot. Returns `not_checked` if a coordinate or `upper` is not
    // finite, or if time runs out. Takes about O(|A| + |B|) time with a grid of points, O(|A| |B|) in the worst case.
    Verdict of_points(const Shape& source, const Pose& source_pose, const Shape& target, const Pose& target_pose) const;

    static const char* words(Verdict verdict);  // text for the fact `certificate` of a reference answer
};

}  // namespace hausbench
