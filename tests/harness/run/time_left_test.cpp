// The estimated remaining time of a run: a solver's finished cases correct the expectations for its other cases.
#include "harness/run/time_left.h"

#include <gtest/gtest.h>

namespace hausbench {
namespace {

constexpr double near = 0.01;  // relative error: the estimate adds one imaginary second that took as long as expected

TEST(SecondsLeft, AreThoseExpectedBeforeAnythingEnded) {
    EXPECT_EQ(seconds_left({{"a", 2, 3}, {"b", 0.5, 4}}, 0), 8);
    EXPECT_EQ(seconds_left({{"a", 2, 3}, {"b", 0.5, 4}}, 5), 8);
    EXPECT_EQ(seconds_left({}, 5), 0);
}

TEST(SecondsLeft, LongCasesFirstPromiseNoLongRun) {
    EXPECT_NEAR(seconds_left({{"a", 1000, 0, 6, 6000}, {"a", 50, 100}}, 6000), 5000, 5000 * near);
    EXPECT_NEAR(seconds_left({{"a", 50, 0, 100, 5000}, {"a", 1000, 6}}, 5000), 6000, 6000 * near)
        << "nor short ones a short run";
}

TEST(SecondsLeft, EachSolverHasAnErrorOfItsOwn) {
    EXPECT_NEAR(seconds_left({{"a", 100, 2, 20, 8000}, {"b", 100, 30, 30, 1500}}, 9500), 2 * 400 + 30 * 50,
                2300 * near);
    EXPECT_NEAR(seconds_left({{"a", 100, 0, 2, 800}, {"b", 100, 3}}, 800), 1200, 1200 * near) << "nothing of b ended";
    EXPECT_NEAR(seconds_left({{"a", 100, 1, 1, 300}, {"a", 200, 1, 1, 900}}, 1200), 1200, 1200 * near) << "one solver";
}

TEST(SecondsLeft, AsMuchRunsSideBySideAsBefore) {
    EXPECT_NEAR(seconds_left({{"a", 100, 8, 8, 1600}}, 800), 800, 800 * near);
    EXPECT_NEAR(seconds_left({{"a", 100, 8, 8, 1600}}, 3200), 1600, 1600 * near) << "never less than one";
}

TEST(SecondsLeft, ALittleWorkTellsLittle) {
    EXPECT_LT(seconds_left({{"a", 0.02, 0, 1, 0.2}, {"a", 100, 1}}, 0.2), 140) << "it took ten times as long";
    EXPECT_GT(seconds_left({{"a", 0.2, 0, 1, 0}, {"a", 100, 1}}, 0.2), 60);
}

TEST(SecondsLeft, WhatIsExpectedToTakeNothingTakesNothing) {
    EXPECT_EQ(seconds_left({{"a", 0, 5, 5, 2}}, 2), 0);
    EXPECT_EQ(seconds_left({{"a", 1, 0, 5, 2}}, 2), 0);
}

}  // namespace
}  // namespace hausbench
