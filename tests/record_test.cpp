// What a row says of its case: the tolerance as a length, and the identity.
#include "record/row.h"
#include "result/provenance.h"

#include <gtest/gtest.h>

#include <set>

namespace hausbench {
namespace {

Case a_case() {
    Case asked;
    asked.solver = asked.label = "guthe";
    asked.options = {{"split", std::string("midpoint")}};
    asked.scene = "needle", asked.source = "a", asked.target = "b";
    asked.source_hash = "aa", asked.target_hash = "bb";
    asked.source_diagonal = 5, asked.source_longest = 4;
    asked.pose_index = 1;
    asked.pose.translation = Vec3(1, 2, 3);
    asked.tolerance = 0.25;
    asked.tolerance_of = "diagonal";
    return asked;
}

TEST(Record, ATolerancesUnitIsOfABoxOrALengthOrTheLowerBound) {
    Points box(2, 3);
    box << -1, 0, 0, 2, 4, 0;
    EXPECT_EQ(diagonal(box), 5);
    EXPECT_EQ(longest_side(box), 4);
    EXPECT_EQ(longest_side(Points(0, 3)), 0);
    Case asked = a_case();
    const auto length = [&](const char* of) {
        asked.tolerance_of = of;
        EXPECT_EQ(asked.resolved_tolerance().of, Tolerance::Of::absolute);
        return asked.resolved_tolerance().value;
    };
    EXPECT_EQ(length("diagonal"), 1.25);
    EXPECT_EQ(length("longest"), 1);
    EXPECT_EQ(length("absolute"), 0.25);
    asked.tolerance_of = "lower";
    EXPECT_EQ(asked.resolved_tolerance().of, Tolerance::Of::lower);
    EXPECT_EQ(asked.resolved_tolerance().value, 0.25);
}

// Results in journals and files are found again by their identity: it must not change for what could be asked before.
TEST(Record, IdentitiesOfOlderCasesStay) {
    EXPECT_EQ(identify(a_case()), "bc6fad1978b2d38f1762e5f589de794e93d97019beb375c912d19b0cc9ad6198");
}

TEST(Record, WhatCameLaterIsPartOfTheIdentityOnlyWhereGiven) {
    std::set<std::string> all = {identify(a_case())};
    Case asked = a_case();
    asked.target_pose.translation = Vec3(3, 2, 1);
    all.insert(identify(asked));
    std::swap(asked.pose, asked.target_pose);
    all.insert(identify(asked));
    asked = a_case();
    asked.warm = true;
    all.insert(identify(asked));
    asked.chain = "cc";
    all.insert(identify(asked));
    asked = a_case();
    asked.quantity = Quantity::symmetric;
    all.insert(identify(asked));
    asked = a_case();
    asked.program_sha256 = "dd";
    all.insert(identify(asked));
    EXPECT_EQ(all.size(), 7u);
}

TEST(Record, TheVersionIsOneLine) {
    const std::string text = version_text();
    EXPECT_EQ(text.find('\n'), std::string::npos);
    for (const std::string& part :
         {this_build().version, this_build().type, this_build().compiler, std::string("commit ")})
        EXPECT_NE(text.find(part), std::string::npos) << text;
}

}  // namespace
}  // namespace hausbench
