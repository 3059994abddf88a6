// Medians and ratios against values computed by hand.
#include "harness/record/estimates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace hausbench {
namespace {

TEST(Median, OneValueHasNoInterval) {
    const Estimate e = median({7});
    EXPECT_EQ(e.value, 7);
    EXPECT_EQ(e.confidence, 0);
    EXPECT_EQ(e.n, 1u);
}

TEST(Median, FewValuesGiveTheirRangeWithTheConfidenceItHas) {
    const Estimate e = median({3, 1, 2});
    EXPECT_EQ(e.value, 2);
    EXPECT_EQ(e.low, 1);
    EXPECT_EQ(e.high, 3);
    EXPECT_DOUBLE_EQ(e.confidence, 1 - 2 * 0.125);  // all three on one side: 2 * 2^-3
}

TEST(Median, TenValuesDropOneAtEachEnd) {
    // P(at most 1 of 10 below) = 11/1024, so [x2, x9] covers the median with 1 - 22/1024 = 97.9 %;
    // [x3, x8] only with 89.1 %.
    const Estimate e = median({10, 9, 8, 7, 6, 5, 4, 3, 2, 1});
    EXPECT_EQ(e.value, 5.5);
    EXPECT_EQ(e.low, 2);
    EXPECT_EQ(e.high, 9);
    EXPECT_NEAR(e.confidence, 1 - 22.0 / 1024, 1e-12);
}

TEST(Median, CoversAsOftenAsItSays) {
    std::mt19937 bits(1);
    int covered = 0;
    constexpr int trials = 4000;
    double promised = 0;
    for (int t = 0; t < trials; ++t) {
        std::vector<double> values(15);
        for (double& v : values) v = -std::log((double(bits()) + 0.5) / 4294967296.0);  // exponential, with median ln 2
        const Estimate e = median(values);
        covered += e.low <= std::log(2.0) && std::log(2.0) <= e.high;
        promised = e.confidence;
    }
    EXPECT_NEAR(double(covered) / trials, promised, 0.015);
}

TEST(PairedRatio, IsInsensitiveToWhatMovesBoth) {
    const std::vector<double> base{1, 2, 4, 8, 16, 32, 64}, twice{2, 4, 8, 16, 32, 64, 128};
    const Estimate r = paired_ratio(base, twice);
    EXPECT_NEAR(r.value, 2, 1e-12);
    EXPECT_TRUE(separated(r));
    EXPECT_FALSE(separated(paired_ratio({1, 2, 1, 2, 1, 2}, {2, 1, 2, 1, 2, 1})));
    EXPECT_FALSE(separated(paired_ratio({1}, {5})));  // one pair says nothing
    EXPECT_THROW(paired_ratio(base, {2, 4}), std::invalid_argument);
}

TEST(Median, NoValuesIsAnError) { EXPECT_THROW(median({}), std::invalid_argument); }

}  // namespace
}  // namespace hausbench
