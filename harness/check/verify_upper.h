// Upper bounds of distances between point sets, for reference answers, which need a proof of their own. Shares nothing with the solvers.
#pragma once

#include "harness/check/verify_exact.h"

namespace hausbench {

struct UpperCheck {
    Quantity quantity = Quantity::directed;
    double upper = 0;
    double seconds = std::numeric_limits<double>::infinity();  // at most, for each direction

    // Whether each point of A (for H: of B, too) has a point of the other set at most `upper` away, where both stand. `holds` and `unsound` are
    // decided in exact rationals if intervals are not enough. `not_checked` if a coordinate or `upper` is not finite, or if time runs out.
    // A grid of cells as wide as `upper` finds the candidates: O(|A| + |B|) if most points of a cell are within `upper` of each other,
    // O(|A| |B|) at worst.
    Verdict of_points(const Shape& source, const Pose& source_pose, const Shape& target, const Pose& target_pose) const;

    static const char* words(Verdict verdict);  // of the fact `certificate` of a reference answer
};

}  // namespace hausbench
