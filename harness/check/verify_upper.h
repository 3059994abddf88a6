// Checks upper bounds on distances between point sets, for reference answers, which need an independent proof.
// Shares nothing with the solvers.
#pragma once

#include "harness/check/verify_exact.h"

namespace hausbench {

struct UpperCheck {
    Quantity quantity = Quantity::directed;
    double upper = 0;
    double seconds = std::numeric_limits<double>::infinity();  // time limit for each direction

    // Returns whether each point of A (for H: of B, too) has a point of the other set, both posed, at most `upper`
    // away. If interval arithmetic cannot decide between `holds` and `unsound`, exact rationals do. Returns
    // `not_checked` if a coordinate or `upper` is not finite, or if time runs out. A grid of cells as wide as `upper`
    // finds the candidates: O(|A| + |B|) if most points of a cell are within `upper` of each other, O(|A| |B|) at
    // worst.
    Verdict of_points(const Shape& source, const Pose& source_pose, const Shape& target, const Pose& target_pose) const;

    static const char* words(Verdict verdict);  // text of the fact `certificate` of a reference answer
};

}  // namespace hausbench
