// The check of upper bounds between point sets, against the rational distances of all pairs.
#include "harness/check/verify_upper.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace hausbench {
namespace {

PointSet cloud(Random& random, Index count, double size, const Vec3& at) {
    PointSet set{Points(count, 3)};
    for (Index i = 0; i < count; ++i)
        for (int k = 0; k < 3; ++k) set.points(i, k) = at[k] + size * (random.unit() - 0.5);
    return set;
}

// Returns h(A,B)^2.
Rational squared(const PointSet& a, const PointSet& b) {
    Rational most = 0;
    for (Index i = 0; i < a.points.rows(); ++i) {
        Rational least = squared_distance(a.points.row(i), {b.points.row(0)});
        for (Index j = 1; j < b.points.rows(); ++j)
            least = std::min(least, squared_distance(a.points.row(i), {b.points.row(j)}));
        most = std::max(most, least);
    }
    return most;
}

// Returns h(A,B) with a small rounding error, even if its square overflows or underflows.
double about(const PointSet& a, const PointSet& b) {
    double most = 0;
    for (Index i = 0; i < a.points.rows(); ++i) {
        double least = std::numeric_limits<double>::infinity();
        for (Index j = 0; j < b.points.rows(); ++j)
            least = std::min(least, (a.points.row(i) - b.points.row(j)).stableNorm());
        most = std::max(most, least);
    }
    return most;
}

Verdict check(const PointSet& a, const PointSet& b, double upper, Quantity quantity = Quantity::directed) {
    return UpperCheck{quantity, upper}.of_points(a, {}, b, {});
}

// The least double that is at least h holds as an upper bound; the double below it does not.
void expect_exact(const PointSet& a, const PointSet& b) {
    const Rational h = squared(a, b);
    double upper = about(a, b);
    while (Rational(upper) * Rational(upper) < h) upper = std::nextafter(upper, 1e300);
    while (upper > 0 && Rational(std::nextafter(upper, 0)) * Rational(std::nextafter(upper, 0)) >= h)
        upper = std::nextafter(upper, 0);
    EXPECT_EQ(check(a, b, upper), Verdict::holds) << upper;
    EXPECT_EQ(check(a, b, 2 * upper), Verdict::holds);
    if (upper > 0) {
        EXPECT_EQ(check(a, b, std::nextafter(upper, 0)), Verdict::unsound) << upper;
        EXPECT_EQ(check(a, b, upper / 2), Verdict::unsound);
        EXPECT_EQ(check(a, b, 0), Verdict::unsound);
    }
}

TEST(VerifyUpper, NeighbouringDoublesAroundTheDistance) {
    Random random(7);
    for (const double size : {1.0, 1e-200, 1e150}) {
        for (const double apart : {0.0, 0.3, 40.0}) {
            const Vec3 away(apart * size, -apart * size, 0);
            expect_exact(cloud(random, 30, size, Vec3::Zero()), cloud(random, 40, size, away));
        }
    }
    expect_exact(cloud(random, 30, 1e-9, Vec3(1, 1e6, 0)),
                 cloud(random, 200, 1, Vec3(1, 1e6, 0)));  // a cluster in a cloud
    const PointSet same = cloud(random, 50, 1, Vec3::Zero());
    expect_exact(same, same);
}

TEST(VerifyUpper, OneOutlierAndBothDirections) {
    Random random(8);
    PointSet a = cloud(random, 60, 1, Vec3::Zero()), b = a;
    b.points.row(17) << 1e6, 0, 0;
    expect_exact(a, b);
    expect_exact(b, a);
    const double there = about(a, b);
    EXPECT_EQ(check(a, b, 2 * there), Verdict::holds);
    EXPECT_EQ(check(a, b, 2 * there, Quantity::symmetric), Verdict::unsound);
    EXPECT_EQ(check(a, b, 2e6, Quantity::symmetric), Verdict::holds);
}

// An outlier of B must not put all other points into one grid cell; equal points of A are checked once.
TEST(VerifyUpper, OutliersAndEqualPointsCostLittle) {
    Random random(10);
    PointSet b = cloud(random, 200000, 1, Vec3::Zero()), a = b;
    b.points.row(0) << 1e15, 0, 0;
    EXPECT_EQ((UpperCheck{Quantity::directed, 0.2, 20}).of_points(a, {}, b, {}), Verdict::holds);
    PointSet same{Points::Zero(200000, 3)}, around = cloud(random, 200000, 1e-3, Vec3(1, 0, 0));
    around.points.row(7) << 0.5, 0, 0;
    EXPECT_EQ((UpperCheck{Quantity::directed, 0.5, 20}).of_points(same, {}, around, {}), Verdict::holds);
    EXPECT_EQ((UpperCheck{Quantity::directed, 0.4, 20}).of_points(same, {}, around, {}), Verdict::unsound);
}

// Interval arithmetic decides no point of B, and exact comparisons are slow, so the clock must be
// read between them. The limit is half of what the whole check takes on this machine.
TEST(VerifyUpper, TimeRunsOutWithinOnePoint) {
    const PointSet a{Points::Zero(1, 3)};
    PointSet b{Points(30000, 3)};
    b.points.col(0).setOnes();
    b.points.rightCols(2).setConstant(1e-170);
    double whole = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 2; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        EXPECT_EQ((UpperCheck{Quantity::directed, 1, 100}).of_points(a, {}, b, {}), Verdict::unsound);
        whole = std::min(whole, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    EXPECT_EQ((UpperCheck{Quantity::directed, 1, whole / 2}).of_points(a, {}, b, {}), Verdict::not_checked);
}

TEST(VerifyUpper, WhatCannotBeTold) {
    Random random(9);
    const PointSet a = cloud(random, 5, 1, Vec3::Zero());
    EXPECT_EQ(check(a, a, std::numeric_limits<double>::infinity()), Verdict::not_checked);
    EXPECT_EQ(check(a, a, -1), Verdict::unsound);
    EXPECT_EQ((UpperCheck{Quantity::directed, 1, 0}).of_points(a, {}, a, {}), Verdict::not_checked);
}

}  // namespace
}  // namespace hausbench
