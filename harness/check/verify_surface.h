// Re-checks a lower bound on algebraic surfaces from its witness p.
//
// Shared with the solvers: the reader of polynomials (kernel/polynomial.h), interval arithmetic (kernel/interval.h) and the
// linear form of a polynomial over a box (FormEvaluator::linear, kernel/interval_form.h). An error in these could pass unseen
// here; tests/algorithms/kernel/kernel_interval_test.cpp compares each with exact rationals. Not shared: the octrees, the search for points, the
// bounds on distances, and the proof below.
//
// A has a point within e of p if its polynomial changes sign on a segment of half length e through p within the box. B has
// none within r = lower + e of p if for every box of a subdivision either 0 is not in f(box), or the box is r away, or for
// some m the function |y - p|^2 - r^2 - m f(y) is nowhere negative in it.
#pragma once

#include "harness/record/row.h"

namespace hausbench {

// `holds`; `unsound` if p is not a proven point of A, or if B has a proven point nearer than `lower`, whose distance
// is then `shown` (0 in the first case); `not_checked` if a million boxes do not settle it.
Verdict check_surface_lower(const AlgebraicSurface& source, const AlgebraicSurface& target, double lower, const Vec3& p,
                            double& shown);

}  // namespace hausbench
