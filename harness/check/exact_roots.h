// Bounds on the square roots of rationals: the nearest doubles below and above.
#pragma once

#include <CGAL/Exact_rational.h>

namespace hausbench {

using Rational = CGAL::Exact_rational;

// Return the largest double whose square is at most `square`, and the smallest whose square is at least `square`
// (infinity if there is none). `square` is not negative; it may be outside the range of doubles.
double root_at_most(const Rational& square);
double root_at_least(const Rational& square);

}  // namespace hausbench
