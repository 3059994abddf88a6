// Plans: lookups take logarithmic time, and known wrong answers are expected.
#include "harness/plan/plan.h"

#include <gtest/gtest.h>

#include <bit>

namespace hausbench {
namespace {

struct Counting {
    std::size_t* count;
    template <class T> bool operator()(const T& a, const T& b) const {
        ++*count;
        return a < b;
    }
};

constexpr std::size_t pose_count = 20'000;
constexpr std::size_t depth =
    2 * std::bit_width(pose_count) + 4;  // depth of a red-black tree, plus a comparison or two

TEST(Lookup, RowsReadOffARowCostNothingOfTheOthers) {
    std::size_t count = 0;
    RowsReadOff<Counting> readers{Counting{&count}};
    for (std::size_t p = 0; p < pose_count; ++p) {
        readers.add(3 * p, 3 * p + 1);
        readers.add(3 * p, 3 * p + 2);
    }
    for (std::size_t p = 0; p < pose_count; p += 999) {
        count = 0;
        EXPECT_EQ(readers.of(3 * p), (std::vector<std::size_t>{3 * p + 1, 3 * p + 2}));
        EXPECT_TRUE(readers.of(3 * p + 1).empty());
        EXPECT_GT(count, 0u);
        EXPECT_LE(count, 2 * depth);
    }
}

TEST(Lookup, TheNearestWorkIsFoundWithoutLookingAtAll) {
    std::size_t count = 0;
    NearestByWork<std::size_t, Counting> lookup{Counting{&count}};
    EXPECT_TRUE(lookup.empty());
    for (std::size_t p = 0; p < pose_count; ++p) lookup.add(100, p);  // the poses of one scene
    for (std::size_t i = 1; i <= 10; ++i) lookup.add(1000.0 * double(i), pose_count + i);
    const auto nearest = [&](double work) {
        count = 0;
        const std::size_t value = lookup.nearest(work);
        EXPECT_LE(count, 2 * depth);
        return value;
    };
    EXPECT_EQ(nearest(100), 0u);  // of equal works, the one added first
    EXPECT_EQ(nearest(1), 0u);
    EXPECT_EQ(nearest(315), 0u);  // the boundary is sqrt(100 * 1000) = 316.2
    EXPECT_EQ(nearest(318), pose_count + 1);
    EXPECT_EQ(nearest(1400), pose_count + 1);  // the boundary is sqrt(1000 * 2000) = 1414.2
    EXPECT_EQ(nearest(1430), pose_count + 2);
    EXPECT_EQ(nearest(1e9), pose_count + 10);
    EXPECT_EQ(nearest(5000), pose_count + 5);
}

TEST(Plan, MarksAreTheGapsReadOffARowTheLargestFirst) {
    Plan plan;
    for (const double tolerance : {1e-3, 1e-2, 1e-1, 1e-3, 1e-2}) {
        Case spec;
        spec.tolerance = tolerance;
        spec.tolerance_of = "absolute";
        plan.cases.push_back(spec);
    }
    plan.read_off(1, {0, false});
    plan.read_off(2, {0, false});
    plan.read_off(4, {3, true});  // an exact solver needs no trace
    EXPECT_EQ(plan.marks(0), (std::vector<double>{1e-1, 1e-2}));
    EXPECT_TRUE(plan.marks(1).empty());
    EXPECT_TRUE(plan.marks(3).empty());
    EXPECT_EQ(plan.traced.size(), 3u);
}

TEST(Plan, WrongAnswersAreExpectedOfKnownErrorsAndOfLabelsThatTheExperimentNames) {
    Experiment experiment;
    Case spec;
    spec.solver = "ohd_as_printed", spec.label = "printed", spec.certified = 0;
    EXPECT_TRUE(unsound_expected(spec, experiment));
    spec.solver = "ohd", spec.label = "ours";
    EXPECT_FALSE(unsound_expected(spec, experiment));
    experiment.expected_unsound = {"theirs", "ours"};
    EXPECT_TRUE(unsound_expected(spec, experiment));
    spec.label = "ohd";
    EXPECT_FALSE(unsound_expected(spec, experiment));
    // A certified solver is never expected to be wrong.
    spec.label = "ours", spec.certified = 1;
    EXPECT_FALSE(unsound_expected(spec, experiment));
}

// A rotation axis may have any length, even if its squared length overflows or underflows.
TEST(Motions, AnAxisMayHaveAnyLength) {
    const Shape shape = PointSet{Points::Random(9, 3)};
    const std::vector<Pose> expected = poses_of(Rotation{{0.5, -1, 2}, 90, 3}, shape);
    for (const int exponent : {-1060, -537, -530, 530, 1000}) {
        const std::vector<Pose> others = poses_of(Rotation{std::ldexp(1.0, exponent) * Vec3(0.5, -1, 2), 90, 3}, shape);
        ASSERT_EQ(others.size(), expected.size());
        for (std::size_t i = 0; i < expected.size(); ++i) {
            EXPECT_EQ(others[i].rotation, expected[i].rotation) << exponent;
            EXPECT_EQ(others[i].translation, expected[i].translation) << exponent;
        }
    }
}

}  // namespace
}  // namespace hausbench
