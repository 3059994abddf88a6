// Square roots of rationals, rounded down and up to doubles, including underflow and overflow.
#include "harness/check/exact_roots.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace hausbench {
namespace {

constexpr double largest = std::numeric_limits<double>::max(), smallest = std::numeric_limits<double>::denorm_min();

Rational squared(double x) { return Rational(x) * Rational(x); }

// Checks that the roots are the largest double not above and the smallest double not below the exact root.
void expect_tight(const Rational& square) {
    const double below = root_at_most(square), above = root_at_least(square);
    EXPECT_LE(squared(below), square);
    const double next = std::nextafter(below, infinity);
    EXPECT_TRUE(!std::isfinite(next) || squared(next) > square);
    EXPECT_EQ(above, squared(below) == square ? below : next);
}

TEST(ExactRoots, OfSquaresAreExact) {
    for (double x : {0.0, smallest, 3 * smallest, 1e-320, 1e-310, std::numeric_limits<double>::min(), 1e-160, 1e-152,
                     1.0, 1e156, 1e308, largest}) {
        EXPECT_EQ(root_at_most(squared(x)), x);
        EXPECT_EQ(root_at_least(squared(x)), x);
        if (x == 0) continue;
        expect_tight(squared(x) + squared(x));
        expect_tight(squared(x) / Rational(3));
    }
}

TEST(ExactRoots, BeyondTheRangeOfDoubles) {
    EXPECT_EQ(root_at_most(Rational(12) * squared(largest)), largest);
    EXPECT_EQ(root_at_least(Rational(12) * squared(largest)), infinity);
    EXPECT_EQ(root_at_most(squared(smallest) / Rational(2)), 0);
    EXPECT_EQ(root_at_least(squared(smallest) / Rational(2)), smallest);
}

TEST(ExactRoots, OfRandomSumsOfSquaresAreTight) {
    Random random(11);
    for (int i = 0; i < 2000; ++i) {
        Rational sum(0);
        for (int k = 0; k < 3; ++k) sum += squared(std::ldexp(random.real(-1, 1), int(random.real(-1080, 1024))));
        expect_tight(sum);
    }
}

}  // namespace
}  // namespace hausbench
