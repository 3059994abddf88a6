// Rows: the tolerance as a length, the identity of the case, and reading many of them.
#include "algorithms/error.h"
#include "algorithms/printable.h"
#include "harness/record/row.h"
#include "harness/result/provenance.h"
#include "harness/result/result_file.h"
#include "harness/run/describe.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace hausbench {
namespace {

Case a_case() {
    Case spec;
    spec.solver = spec.label = "guthe";
    spec.options = {{"split", std::string("midpoint")}};
    spec.scene = "needle", spec.source = "a", spec.target = "b";
    spec.source_hash = "aa", spec.target_hash = "bb";
    spec.source_diagonal = 5, spec.source_longest = 4;
    spec.pose_index = 1;
    spec.pose.translation = Vec3(1, 2, 3);
    spec.tolerance = 0.25;
    spec.tolerance_of = "diagonal";
    return spec;
}

TEST(Printable, LeavesTextAndTakesWhatSteersATerminal) {
    EXPECT_EQ(printable("Größe 3 µm, 漢字 𝄞"), "Größe 3 µm, 漢字 𝄞");
    EXPECT_EQ(printable("a\x1b[2J\n\x7f\t"), "a [2J   ");
    EXPECT_EQ(printable("\xc2\x9b"
                        "31m \xe2\x80\xa8"),
              " 31m  ")
        << "U+009B, U+2028";
    EXPECT_EQ(printable("\xe2\x80\xae"
                        "abc"),
              "?abc")
        << "U+202E";
    EXPECT_EQ(printable("caf\xe9, \xc0\x80, \xed\xa0\x80, \xf5"), "caf?, ??, ???, ?") << "not UTF-8";
    EXPECT_EQ(printable("\033[31mred"), " [31mred");
    EXPECT_EQ(printable_lines("\033[31mred\033[0m\n\033[2J", true), "\033[31mred\033[0m\n [2J");
    EXPECT_EQ(printable_lines("\033[31mred\n", false), " [31mred\n");
    const std::string almost_full(999, 'x');
    EXPECT_EQ(one_line(almost_full + "ä"), almost_full) << "no half of a character";
}

TEST(Record, ATolerancesUnitIsOfABoxOrALengthOrTheLowerBound) {
    Points box(2, 3);
    box << -1, 0, 0, 2, 4, 0;
    EXPECT_EQ(diagonal(box), 5);
    EXPECT_EQ(longest_side(box), 4);
    EXPECT_EQ(longest_side(Points(0, 3)), 0);
    Case spec = a_case();
    const auto length = [&](const char* of) {
        spec.tolerance_of = of;
        EXPECT_EQ(spec.resolved_tolerance().of, Tolerance::Of::absolute);
        return spec.resolved_tolerance().value;
    };
    EXPECT_EQ(length("diagonal"), 1.25);
    EXPECT_EQ(length("longest"), 1);
    EXPECT_EQ(length("absolute"), 0.25);
    spec.tolerance_of = "lower";
    EXPECT_EQ(spec.resolved_tolerance().of, Tolerance::Of::lower);
    EXPECT_EQ(spec.resolved_tolerance().value, 0.25);
}

// Journals and result files find results by identity, so the identity of a case must not change between versions.
TEST(Record, IdentitiesOfOlderCasesStay) {
    EXPECT_EQ(identify(a_case()), "bc6fad1978b2d38f1762e5f589de794e93d97019beb375c912d19b0cc9ad6198");
}

TEST(Record, WhatCameLaterIsPartOfTheIdentityOnlyWhereGiven) {
    std::set<std::string> all = {identify(a_case())};
    Case spec = a_case();
    spec.target_pose.translation = Vec3(3, 2, 1);
    all.insert(identify(spec));
    std::swap(spec.pose, spec.target_pose);
    all.insert(identify(spec));
    spec = a_case();
    spec.warm = true;
    all.insert(identify(spec));
    spec.chain = "cc";
    all.insert(identify(spec));
    spec = a_case();
    spec.quantity = Quantity::symmetric;
    all.insert(identify(spec));
    spec = a_case();
    spec.program_sha256 = "dd";
    all.insert(identify(spec));
    EXPECT_EQ(all.size(), 7u);
}

TEST(Record, TheVersionIsOneLine) {
    const std::string text = version_text();
    EXPECT_EQ(text.find('\n'), std::string::npos);
    for (const std::string& part :
         {this_build().version, this_build().type, this_build().compiler, std::string("commit ")})
        EXPECT_NE(text.find(part), std::string::npos) << text;
}

// Each row looks up its models by name. With a linear search, reading this file would take so long
// that it counts as damaged.
TEST(Record, AResultOfManyModelsIsRead) {
    constexpr std::size_t models = 120'000;
    const TemporaryFolder folder;
    const auto file = folder.path() / "many.h5";
    ResultFile result;
    describe_run(result, Plan{}, "", "");
    for (std::size_t i = 0; i < models; ++i) {
        ModelRecord model;
        model.name = "a name that many others begin with " + std::to_string(i);
        model.sha256 = std::to_string(7 * i);
        result.models.push_back(std::move(model));
    }
    for (std::size_t i = 0; i < models / 4; ++i) {
        Row row{a_case(), {}, {}};
        row.spec.source = result.models[4 * i].name, row.spec.target = result.models[models - 1 - i].name;
        result.rows.push_back(std::move(row));
    }
    write_result(file, result);
    const ResultFile again = read_result(file);
    ASSERT_EQ(again.rows.size(), result.rows.size());
    for (std::size_t i = 0; i < again.rows.size(); ++i) {
        ASSERT_EQ(again.rows[i].spec.source_hash, result.models[4 * i].sha256);
        ASSERT_EQ(again.rows[i].spec.target_hash, result.models[models - 1 - i].sha256);
    }
}

}  // namespace
}  // namespace hausbench
