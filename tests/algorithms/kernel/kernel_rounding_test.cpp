// The lemmas of kernel/rounding.h against exact rational arithmetic, each bound in the worst case
// that its derivation allows.
#include "algorithms/kernel/rounding.h"

#include "algorithms/kernel/point_triangle.h"
#include "tests/support/exact.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using exact::Rational;
using exact::RVec3;

Rational power(const Rational& x, int n) { return n == 0 ? Rational(1) : x * power(x, n - 1); }

// --- point to point --------------------------------------------------------------------------------------------------

TEST(PointDistance, BoundsHoldAgainstExactArithmetic) {
    Random random(1);
    for (int i = 0; i < 20000; ++i) {
        const Vec3 a = random.vector(), b = i % 2 == 0 ? random.vector() : Vec3(a + 1e-12 * random.vector());
        const double squared = squared_length(a - b);
        const Rational low = distance_at_least(squared, false), high = distance_at_most(squared, false);
        const Rational expected = exact::squared_distance(exact::vector(a), exact::vector(b));
        ASSERT_TRUE(low * low <= expected && expected <= high * high) << i;
    }
}

// A computed distance f allows any exact distance from f / (1 + u)^3.5 to f / (1 - u)^3.5; few pairs of points come
// close to these ends.
TEST(PointDistance, BoundsCoverTheWorstThatIsDerived) {
    Random random(2);
    const Rational u = unit_roundoff, less = power(1 - u, 7), more = power(1 + u, 7);
    for (int i = 0; i < 20000; ++i) {
        const double squared = random.real(1, 4);
        const Rational f = std::sqrt(squared), low = distance_at_least(squared, false),
                       high = distance_at_most(squared, false);
        ASSERT_TRUE(low * low * more <= f * f) << squared;
        ASSERT_TRUE(high * high * less >= f * f) << squared;
    }
}

TEST(PointDistance, BoundsHoldWhereSquaresUnderflow) {
    Random random(3);
    int vanished = 0;
    for (int i = 0; i < 2000; ++i) {
        const double size = std::ldexp(1, -520 - static_cast<int>(random.below(25)));
        const Vec3 a = random.vector(size), b = random.vector(size);
        const double squared = squared_length(a - b);
        const Rational low = distance_at_least(squared, true), high = distance_at_most(squared, true);
        const Rational expected = exact::squared_distance(exact::vector(a), exact::vector(b));
        ASSERT_TRUE(low * low <= expected && expected <= high * high) << i;
        vanished += squared == 0;
        // The allowance for underflow leaves larger distances a useful bound.
        EXPECT_GT(distance_at_least(0x1p-900, true), 0x1p-451);
    }
    EXPECT_GT(vanished, 10);
}

// --- subdivided triangles --------------------------------------------------------------------------------------------

// A piece of a triangle as solvers compute it, and the exact piece that it represents.
struct Chain {
    std::array<Vec3, 3> rounded;
    std::array<RVec3, 3> exact;
    int level = 0;

    void halve(std::size_t from, std::size_t to, Vec3& middle, RVec3& exact_middle) const {
        middle = 0.5 * (rounded[from] + rounded[to]);
        for (std::size_t k = 0; k < 3; ++k) exact_middle[k] = (exact[from][k] + exact[to][k]) / 2;
    }
};

// Returns one of the four pieces of a split at the edge midpoints, or one of the two pieces of a bisection.
Chain piece_of(const Chain& chain, Random& random) {
    Chain next = chain;
    ++next.level;
    const std::size_t kept = static_cast<std::size_t>(random.below(5));
    for (std::size_t k = 0; k < 3; ++k) {  // 3: the middle piece; 4: bisection
        if (kept == k || (kept == 4 && k != 0)) continue;
        const std::size_t from = kept < 3 ? kept : (k + 1) % 3, to = kept < 3 ? k : (k + 2) % 3;
        chain.halve(from, to, next.rounded[k], next.exact[k]);
    }
    return next;
}

// Returns a triangle whose coordinates are slightly above 1, so that sums of corners have the largest rounding error.
Chain chain_of(Random& random) {
    Chain chain;
    const double size = std::pow(2, random.real(-30, -1));
    for (std::size_t k = 0; k < 3; ++k) {
        chain.rounded[k] = Vec3::Ones() + 0.5 * size * (Vec3::Ones() + random.vector());
        chain.exact[k] = exact::vector(chain.rounded[k]);
    }
    return chain;
}

double magnitude_of(const Chain& chain) {
    double most = 0;
    for (const Vec3& corner : chain.rounded) most = std::max(most, corner.cwiseAbs().maxCoeff());
    return most;
}

// Calls check(chain, magnitude) for random pieces after 0 to 24 halvings.
template <class Check> void for_each_chain(Check check) {
    Random random(4);
    for (int i = 0; i < 300; ++i) {
        Chain chain = chain_of(random);
        const double magnitude = magnitude_of(chain);
        check(chain, magnitude);
        while (chain.level < 24) {
            chain = piece_of(chain, random);
            check(chain, magnitude);
        }
    }
}

TEST(Midpoints, AVertexAfterKHalvingsIsWithinRoot3kuM) {
    long double most = 0;
    for_each_chain([&](const Chain& chain, double magnitude) {
        const Rational unit = Rational(unit_roundoff) * Rational(magnitude);
        for (std::size_t k = 0; k < 3; ++k) {
            const Rational off = exact::squared_distance(chain.exact[k], exact::vector(chain.rounded[k]));
            ASSERT_TRUE(off <= Rational(3 * chain.level * chain.level) * unit * unit) << chain.level;
            most = std::max(most, exact::root(Rational(off / (unit * unit))));
        }
    });
    EXPECT_GT(most, 1.7) << "the chains do not come near what is derived";
}

// The bound must cover the rounding of a point-to-point distance, the errors of midpoints, and the 7 * u * M by which a
// closest point may be off B.
TEST(SurfaceDistance, UpperBoundsCoverTheKernelAndTheMidpoints) {
    Random random(5);
    for_each_chain([&](const Chain& chain, double magnitude) {
        const Rational kernel = 7 * Rational(unit_roundoff) * Rational(magnitude);
        for (std::size_t k = 0; k < 3; ++k) {
            for (const double far : {0.0, 1e-16, 1e-15, 1e-2, 0.9}) {
                const Vec3 q = chain.rounded[k] - far * Vec3(random.vector().cwiseAbs());
                const double squared = squared_length(chain.rounded[k] - q);
                const Rational bound = surface_distance_at_most(squared, magnitude, chain.level) - kernel;
                ASSERT_TRUE(bound >= 0) << chain.level;
                ASSERT_TRUE(bound * bound >= exact::squared_distance(chain.exact[k], exact::vector(q))) << chain.level;
            }
        }
    });
}

// Tries distances up to 2 * sqrt(3) * M, the largest between points of magnitude M, at which the sum has its largest
// rounding error; and a square that underflows.
TEST(SurfaceDistance, UpperBoundsCoverTheRoundingOfTheSum) {
    Random random(8);
    for (int i = 0; i < 20000; ++i) {
        const double magnitude = random.real(1, 2),
                     away = i % 2 ? 2 * std::sqrt(3.0) * random.unit() : random.real(0, 1e-15);
        // The least square that can be computed for the distance d; its root is d * (1 - 3.5u).
        const Rational d = away * magnitude;
        const double f = away * magnitude * (1 - 3.5 * unit_roundoff);
        double squared = f * f;
        while (Rational(squared) > Rational(f) * Rational(f)) squared = next_down(squared);
        while (Rational(std::sqrt(squared)) < d * (1 - Rational(3.5) * Rational(unit_roundoff)))
            squared = next_up(squared);
        for (const int level : {0, 1, 7}) {
            const Rational others = (7 + 2 * level) * Rational(unit_roundoff) * Rational(magnitude);
            ASSERT_TRUE(Rational(surface_distance_at_most(squared, magnitude, level)) >= d + others) << i;
        }
    }
    // (1.2 * 2^-537)^2 is 1.44 times the smallest double and is rounded down to it.
    const double d = 1.2 * 0x1p-537, least = smallest_safe_magnitude;
    ASSERT_LT(std::sqrt(d * d), d);
    EXPECT_TRUE(Rational(surface_distance_at_most(d * d, least, 0)) >=
                Rational(d) + 7 * Rational(unit_roundoff) * Rational(least));
}

TEST(SurfaceDistance, LowerBoundsCoverTheMidpoints) {
    Random random(7);
    for_each_chain([&](const Chain& chain, double magnitude) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 q = chain.rounded[k] + std::pow(10, random.real(-14, 0)) * random.vector();
            const Rational squared = exact::squared_distance(exact::vector(chain.rounded[k]), exact::vector(q));
            double certified = static_cast<double>(exact::root(squared));
            while (Rational(certified) * Rational(certified) > squared) certified = next_down(certified);
            const Rational low = surface_distance_at_least(certified, magnitude, chain.level);
            ASSERT_TRUE(low * low <= exact::squared_distance(chain.exact[k], exact::vector(q))) << chain.level;
            if (chain.level == 0) {
                ASSERT_TRUE(low == Rational(certified));
            }
        }
    });
}

// At distances above 4, with M below 2, rounding absorbs the term 2 * u * M, which is less than half an ulp. The exact
// midpoint may still be nearer by sqrt(3) * u.
TEST(SurfaceDistance, LowerBoundsCoverTheRoundingOfTheDifference) {
    Random random(9);
    int absorbed = 0;
    for (int i = 0; i < 20000; ++i) {
        const auto corner = [&] { return Vec3(random.real(1.5, 1.9), random.real(1.5, 1.9), random.real(1.5, 1.9)); };
        Chain chain;
        chain.rounded = {corner(), corner(), corner()};
        for (std::size_t k = 0; k < 3; ++k) chain.exact[k] = exact::vector(chain.rounded[k]);
        Vec3 middle;
        RVec3 exact_middle;
        chain.halve(0, 1, middle, exact_middle);
        const Vec3 q = -corner();
        const Rational squared = exact::squared_distance(exact::vector(middle), exact::vector(q));
        double certified = static_cast<double>(exact::root(squared));
        while (Rational(certified) * Rational(certified) > squared) certified = next_down(certified);
        const Rational low = surface_distance_at_least(certified, 1.9, 1);
        ASSERT_TRUE(low * low <= exact::squared_distance(exact_middle, exact::vector(q))) << i;
        absorbed += certified - 2 * unit_roundoff * 1.9 == certified;
    }
    EXPECT_GT(absorbed, 19000);
}

TEST(SurfaceDistance, AllAtTheOriginIsZero) {
    EXPECT_EQ(surface_distance_at_most(0, 0, 3), 0);
    EXPECT_EQ(surface_distance_at_least(0, 0, 3), 0);
}

}  // namespace
}  // namespace hausbench
