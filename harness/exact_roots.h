// Square roots of rationals, as doubles on either side.
#pragma once

#include <CGAL/Exact_rational.h>

namespace hausbench {

using Rational = CGAL::Exact_rational;

// The largest double whose square is at most `square`, and the smallest whose square is at least that (infinity where there
// is none). For every square that is not negative, also where it is itself too large or too small for a double.
double root_at_most(const Rational& square);
double root_at_least(const Rational& square);

}  // namespace hausbench
