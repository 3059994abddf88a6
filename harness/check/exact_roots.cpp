#include "harness/check/exact_roots.h"

#include "algorithms/kernel/geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hausbench {
namespace {

double up(double x) { return std::nextafter(x, infinity); }

bool fits(double root, const Rational& square) { return Rational(root) * Rational(root) <= square; }

// Returns the square root to within a few units in the last place. Squares of doubles and their sums lie between
// 2^-2200 and 2^2200, so a few scaling steps are enough.
double guess(Rational square) {
    const Rational large(std::ldexp(1.0, 1000)), small(std::ldexp(1.0, -1000));
    int exponent = 0;
    for (; square > large; exponent += 500) square *= small;
    for (; square < small; exponent -= 500) square *= large;
    return std::ldexp(std::sqrt(CGAL::to_double(square)), exponent);
}

}  // namespace

double root_at_most(const Rational& square) {
    if (square <= Rational(0)) return 0;
    double root = std::min(guess(square), std::numeric_limits<double>::max());
    while (!fits(root, square)) root = std::nextafter(root, 0);
    while (std::isfinite(up(root)) && fits(up(root), square)) root = up(root);
    return root;
}

double root_at_least(const Rational& square) {
    const double root = root_at_most(square);
    return Rational(root) * Rational(root) == square ? root : up(root);
}

}  // namespace hausbench
