// Square roots of rationals, rounded down or up to a double.
#pragma once

#include <CGAL/Exact_rational.h>

namespace hausbench {

using Rational = CGAL::Exact_rational;

// root_at_most() returns the largest double whose square is at most `square`. root_at_least() returns the smallest
// double whose square is at least `square`, or infinity. `square` must not be negative, but may be outside the range of
// doubles.
double root_at_most(const Rational& square);
double root_at_least(const Rational& square);

}  // namespace hausbench
