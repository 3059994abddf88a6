// Re-checks a lower bound on the distance of algebraic surfaces from its witness p.
//
// Shared with the solvers: the reader of polynomials (kernel/polynomial.h), interval arithmetic (kernel/interval.h) and
// the linear form of a polynomial over a box (FormEvaluator::linear, kernel/interval_form.h). An error in these could
// go unnoticed here; tests/algorithms/kernel/kernel_interval_test.cpp compares each with exact rationals. Not shared:
// the octrees, the search for points, the bounds on distances, and the proof below.
//
// A has a point within e of p if its polynomial changes sign along a segment that lies in the box of A and within e of
// p.
//
// B is the zero set of a polynomial f in its box, which is subdivided into smaller boxes. B has no point nearer to p
// than r = lower + e if each of these boxes has one of three properties:
// - 0 is not in f(box), so B has no point in the box.
// - The box is at least r away from p.
// - For some number m, the function |y - p|^2 - r^2 - m * f(y) of y is nowhere negative in the box. At a point y of B,
//   where f(y) = 0, this says |y - p| >= r.
#pragma once

#include "harness/record/row.h"

namespace hausbench {

// Returns `holds` if the witness p proves `lower`. Returns `unsound` if no point of A is proven near p (`shown` is 0),
// or if B has a proven point nearer to p than `lower` (`shown` is an upper bound on its distance). Returns
// `not_checked` if a million boxes prove neither, or if boxes would become too small.
Verdict check_surface_lower(const AlgebraicSurface& source, const AlgebraicSurface& target, double lower, const Vec3& p,
                            double& shown);

}  // namespace hausbench
