// Printed results: table widths, bounds rounded outward, reasons, comparisons of solvers, and progress lines.
#include "algorithms/error.h"
#include "datasets/hash.h"
#include "harness/commands/comparison.h"
#include "harness/commands/row_choice.h"
#include "harness/commands/row_table.h"
#include "harness/commands/row_texts.h"
#include "harness/commands/summary.h"
#include "harness/record/columns.h"
#include "harness/record/row_times.h"
#include "harness/run/describe.h"
#include "harness/run/progress.h"
#include "tests/support/temporary_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <random>
#include <regex>
#include <sstream>

namespace hausbench {
namespace {

Row row(const std::string& label, const std::string& scene, double lower, double upper,
        const std::string& variant = "") {
    Row row;
    row.spec.solver = row.spec.label = label;
    row.spec.variant = variant;
    row.spec.scene = scene;
    row.spec.source = row.spec.target = "model";
    row.spec.tolerance = 0.001;
    row.spec.tolerance_of = "diagonal";
    row.spec.profile = "quick";
    row.outcome.status = RowStatus::ok;
    row.outcome.bounds = {lower, upper};
    row.outcome.clock = "cpu";
    row.check.lower = row.check.upper = Verdict::holds;
    return row;
}

ResultFile result_of(std::vector<Row> rows) {
    ResultFile result;
    result.texts = {{"stem", "test"}, {"profile", "quick"}};
    result.rows = std::move(rows);
    return result;
}

// Sets the repeats of each round, and a first answer that takes twice as long as the first repeat.
void time_it(Row& row, const std::vector<std::vector<double>>& rounds) {
    for (std::size_t r = 0; r < rounds.size(); ++r) {
        row.outcome.answers.push_back({int(r), 4 * rounds[r].front(), 2 * rounds[r].front()});
        for (const double s : rounds[r]) row.outcome.repeats.push_back({int(r), 2 * s, s, 1});
        row.outcome.preparation.push_back({int(r), "target BVH", 10, 0, 0});
    }
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

std::size_t characters(const std::string& text) {
    return std::size_t(std::count_if(text.begin(), text.end(), [](unsigned char c) { return (c & 0xC0) != 0x80; }));
}

TEST(TextTable, NeverWiderThanThePaper) {
    TextTable table(
        {{"solver", false, 0, true}, {"scene", false, 0, true}, {"µ", true, 2}, {"memory", true, 3}, {"status"}});
    table.add({{"surface_enclosure", "a scene with a very long name", "12 µs", "120 MB", "ok"}});
    table.add(
        {{"guthe", "é", "1 µs", "1 MB", "failed"}, "a reason of many words that stands below its row and is wrapped"});
    for (std::size_t width = 20; width <= 120; ++width) {
        const std::string text = table.text({width, false});
        for (const std::string& line : lines_of(text)) EXPECT_LE(characters(line), width) << line;
        EXPECT_NE(text.find("failed"), std::string::npos) << "a column of rank 0 is never left out";
        EXPECT_NE(text.find("wrapped"), std::string::npos);
    }
    std::vector<std::string> left;
    table.text({60, false}, &left);
    EXPECT_EQ(left, (std::vector<std::string>{"µ", "memory"}));
    left.clear();
    table.text({0, false}, &left);
    EXPECT_TRUE(left.empty());
    const auto wide = lines_of(table.text({0, false}));
    ASSERT_EQ(wide.size(), 4u);
    EXPECT_EQ(wide[0], "solver             scene                              µ  memory  status");
    EXPECT_EQ(wide[1], "surface_enclosure  a scene with a very long name  12 µs  120 MB  ok");
}

TEST(TextTable, ColourOnlyWhereThePaperHasIt) {
    TextTable table({{"solver"}});
    table.add({{"guthe"}, "", Colour::red});
    EXPECT_EQ(table.text({0, false}).find('\033'), std::string::npos);
    EXPECT_NE(table.text({0, true}).find("\033[31mguthe\033[0m"), std::string::npos);
}

TEST(Times, TheRoundIsTheUnit) {
    Row timed = row("guthe", "a", 1, 2);
    time_it(timed, {{1, 2, 100}, {5, 6, 7}, {3, 3, 3}});
    EXPECT_EQ(again_by_round(timed.outcome, true), (ByRound{{0, 2}, {1, 6}, {2, 3}}));
    EXPECT_EQ(again_by_round(timed.outcome, false), (ByRound{{0, 4}, {1, 12}, {2, 6}}));
    EXPECT_EQ(total_by_round(timed.outcome, true), (ByRound{{0, 12}, {1, 20}, {2, 16}}));
    const Estimate time = time_of(timed.outcome);
    EXPECT_EQ(time.n, 3u);
    EXPECT_EQ(time.value, 3);
    EXPECT_EQ(time.low, 2);
    EXPECT_EQ(time.high, 6);
    timed.outcome.repeats.resize(3);  // with a single round, its repeats are compared
    EXPECT_EQ(time_of(timed.outcome).value, 2);
    EXPECT_EQ(time_of(timed.outcome).low, 1);
    EXPECT_EQ(time_of(timed.outcome).high, 100);
    EXPECT_EQ(time_of(timed.outcome).confidence, 0) << "they are no independent measurements";
    timed.outcome.repeats.clear();
    EXPECT_EQ(time_of(timed.outcome).value, 6) << "first answers";
    EXPECT_EQ(time_of(row("guthe", "a", 1, 2).outcome).n, 0u);
    const Estimate ratio = ratio_by_round({{0, 1}, {2, 4}}, {{0, 2}, {1, 9}, {2, 8}});
    EXPECT_EQ(ratio.n, 2u);
    EXPECT_DOUBLE_EQ(ratio.value, 2);
    EXPECT_EQ(ratio_by_round({{0, 1}}, {{1, 1}}).n, 0u);
}

TEST(Show, DurationsHaveThreeDigitsAndTheirUnit) {
    EXPECT_EQ(duration_text(999.4e-6), "999 µs");
    EXPECT_EQ(duration_text(999.6e-6), "1 ms");
    EXPECT_EQ(duration_text(0.9996), "1 s");
    EXPECT_EQ(duration_text(999.6), "1000 s");
    EXPECT_EQ(duration_text(12345), "12345 s");
}

TEST(Show, BoundsHoldAsShown) {
    std::vector<Row> rows;
    for (double scale : {1.0, 1e-300, 1e-310, 1e-7, 12345.0, 1e300}) {
        for (double x : {1.0 / 3, 2.0 / 3, 0.9999999999, 0.1, 1.00000049, 0.100000051})
            rows.push_back(row("guthe", "a", x * scale, x * scale));
    }
    const ResultFile result = result_of(rows);
    std::vector<std::size_t> all(rows.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    const auto lines = lines_of(show_rows(result, all, TableForm::text, {}));
    for (std::size_t i = 0; i < rows.size(); ++i) {
        std::istringstream in(lines[i + 1]);
        std::string solver, scene;
        double lower = 0, upper = 0;
        in >> solver >> scene >> lower >> upper;
        const double h = rows[i].outcome.bounds.lower;
        EXPECT_LE(lower, h) << lines[i + 1];
        EXPECT_GE(upper, h) << lines[i + 1];
        EXPECT_LE(upper - lower, 3e-5 * h) << lines[i + 1];
    }
}

TEST(Show, ChoosesBySolverSceneAndColumn) {
    Row late = row("guthe", "b", 1, 2, "samples=8");
    late.spec.pose_index = 3;
    late.outcome.status = RowStatus::timeout;
    const ResultFile result = result_of({row("guthe", "a", 1, 2, "samples=4"), late, row("cgal", "a", 1, 1.5)});
    using Rows = std::vector<std::size_t>;
    EXPECT_EQ(chosen_rows(result, {}), (Rows{0, 1, 2}));
    EXPECT_EQ(chosen_rows(result, {{"guthe"}, {}, {}}), (Rows{0, 1}));
    EXPECT_EQ(chosen_rows(result, {{"guthe(samples=8)"}, {}, {}}), (Rows{1}));
    EXPECT_EQ(chosen_rows(result, {{}, {"a"}, {}}), (Rows{0, 2}));
    EXPECT_EQ(chosen_rows(result, {{}, {}, {"status=timeout"}}), (Rows{1}));
    EXPECT_EQ(chosen_rows(result, {{}, {}, {"status!=timeout", "upper=1.5"}}), (Rows{2}));
    EXPECT_EQ(chosen_rows(result, {{}, {}, {"pose=3"}}), (Rows{1})) << "as the table calls it";
    for (const RowChoice& wrong :
         {RowChoice{{"gute"}, {}, {}}, RowChoice{{}, {"c"}, {}}, RowChoice{{}, {}, {"stat=ok"}},
          RowChoice{{}, {}, {"upper=big"}}, RowChoice{{}, {}, {"target_pose=1"}}, RowChoice{{}, {}, {"ok"}}})
        EXPECT_THROW(chosen_rows(result, wrong), InputError);
}

TEST(Show, ChoosesProfilesThatShareARowAndWhatIsNotANumber) {
    Row both = row("guthe", "a", unknown, unknown);
    both.spec.profile = "paper,quick";
    const ResultFile result = result_of({row("guthe", "a", 1, 2), both});
    using Rows = std::vector<std::size_t>;
    EXPECT_EQ(chosen_rows(result, {{}, {}, {"profile=quick"}}), (Rows{0, 1}));
    EXPECT_EQ(chosen_rows(result, {{}, {}, {"profile=paper"}}), (Rows{1}));
    EXPECT_EQ(chosen_rows(result, {{}, {}, {"profile!=paper"}}), (Rows{0}));
    EXPECT_EQ(chosen_rows(result, {{}, {}, {"profile=paper,quick"}}), (Rows{1}));
    EXPECT_EQ(chosen_rows(result, {{}, {}, {"lower=nan"}}), (Rows{1}));
    EXPECT_EQ(chosen_rows(result, {{}, {}, {"lower!=nan"}}), (Rows{0}));
}

TEST(Show, NoControlCharactersInTables) {
    Row hostile = row("la\033[31m\r\nbel",
                      "sc\xC2\x9B"
                      "31mene\n",
                      1, 2);
    hostile.outcome.status = RowStatus::failed;
    hostile.outcome.reason = "it said \033[2J\a and\nmore";
    const ResultFile result = result_of({hostile});
    for (const TableForm form : {TableForm::text, TableForm::markdown}) {
        for (const std::size_t width : {0, 20, 60}) {
            const std::string text = show_rows(result, {0}, form, {width, false});
            EXPECT_EQ(text.find_first_of("\033\a\r"), std::string::npos);
            EXPECT_EQ(text.find("\xC2\x9B"), std::string::npos);
        }
    }
    EXPECT_EQ(lines_of(show_rows(result, {0}, TableForm::markdown, {})).size(), 3u);
    EXPECT_EQ(lines_of(show_rows(result, {0}, TableForm::text, {})).size(), 4u) << "title, row, reason, counts";
    EXPECT_EQ(show_summary(result, {}).find_first_of("\033\a\r"), std::string::npos);
    EXPECT_EQ(lines_of(show_rows(result_of({row("a\rb", "s", 1, 2)}), {0}, TableForm::csv, {}))[1].substr(0, 11),
              "\"a\rb\",\"a\rb\"");
}

TEST(Show, ARowThatNobodyCheckedDoesNotHold) {
    Row without = row("cgal", "a", 1, 2);
    without.check.lower = Verdict::no_witness;
    Row refuted = row("cgal", "a", 1, 2);
    refuted.check.upper = Verdict::unsound;
    const ResultFile result = result_of({row("guthe", "a", 1, 2), without, refuted});
    const auto lines = lines_of(show_rows(result, {0, 1, 2}, TableForm::csv, {}));
    EXPECT_NE(lines[1].find(",holds,"), std::string::npos);
    EXPECT_NE(lines[2].find(",not checked,"), std::string::npos);
    EXPECT_NE(lines[3].find(",unsound,"), std::string::npos);
}

TEST(Show, TheSummaryNamesEveryReasonOnce) {
    std::vector<Row> rows;
    for (int i = 0; i < 12; ++i) {
        rows.push_back(row("ohd", "a", 1, 2, fmt::format("seed={}", i)));
        rows.push_back(row("guthe", fmt::format("s{}", i), 1, 2));
        if (i % 4 != 0) continue;
        rows.back().outcome.status = RowStatus::unsound;
        rows.back().outcome.reason = fmt::format("lower 0.{}e-5 is above {}", i + 1, i);
    }
    rows.push_back(row("guthe", "last", unknown, unknown));
    rows.back().outcome.status = RowStatus::failed;
    rows.back().outcome.reason = "it crashed";
    const std::string text = show_summary(result_of(rows), {});
    const auto lines = lines_of(text);
    ASSERT_EQ(lines.size(), 5u) << text;
    EXPECT_EQ(lines[1].substr(0, 16), "ohd(12 variants)");
    EXPECT_NE(lines[2].find("9 ok, 1 failed, 3 unsound"), std::string::npos) << text;
    EXPECT_EQ(lines[3],
              "guthe: unsound: lower 0.1e-5 is above 0 (3 rows like this; the first: s0, pose 0, tolerance 0.001)");
    EXPECT_EQ(lines[4], "guthe: failed: it crashed (last, pose 0, tolerance 0.001)");
}

TEST(Compare, IntervalsThatDoNotOverlapComeFirst) {
    std::vector<Row> rows;
    for (int i = 0; i < 3; ++i) {
        rows.push_back(row("guthe", fmt::format("s{}", i), 1, 2));
        rows.push_back(row("cgal", fmt::format("s{}", i), i == 1 ? 2.5 : 1.5, 3));
        time_it(rows[rows.size() - 2], {{1}, {2}, {1}, {3}, {1}, {1}});
        time_it(rows.back(), {{2}, {4}, {2}, {6}, {2}, {2}});
    }
    rows.push_back(row("guthe", "alone", 1, 2));
    const std::string text = compare_solvers(result_of(rows), "guthe", "cgal", {});
    const auto lines = lines_of(text);
    EXPECT_EQ(lines[0], "3 pairs of guthe and cgal; rows without a partner: 1 of guthe, 0 of cgal");
    EXPECT_EQ(lines[1], "INTERVALS THAT DO NOT OVERLAP");
    EXPECT_NE(lines[2].find("s1, pose 0"), std::string::npos);
    EXPECT_TRUE(std::regex_search(text, std::regex("s0, pose 0, tolerance 0.001 +slower 2 \\[2, 2\\]"))) << text;
    EXPECT_NE(text.find("geometric mean of solving again over 3 pairs: 2\n"), std::string::npos) << text;
    EXPECT_NE(compare_solvers(result_of(rows), "cgal", "guthe", {}).find("faster"), std::string::npos);
    EXPECT_THROW(compare_solvers(result_of(rows), "guthe", "gcal", {}), InputError);
    EXPECT_THROW(compare_solvers(result_of({row("a", "s", 1, 2), row("b", "t", 1, 2)}), "a", "b", {}), InputError);
}

// Returns a row with a random speed in each round, and nearly equal times within a round.
Row noisy_row(const std::string& scene, int rounds, int repeats, std::mt19937_64& bits) {
    std::lognormal_distribution<double> round_takes(0, 0.2), repeat_takes(0, 0.001);
    Row noisy = row("guthe", scene, 1, 2);
    for (int round = 0; round < rounds; ++round) {
        const double usual = round_takes(bits);
        for (int i = 0; i < repeats; ++i) {
            const double seconds = usual * repeat_takes(bits);
            noisy.outcome.repeats.push_back({round, seconds, seconds, 1});
        }
    }
    return noisy;
}

std::size_t verdicts_in(const std::string& text) {
    const std::regex verdict(" (faster|slower)\n");
    return std::size_t(std::distance(std::sregex_iterator(text.begin(), text.end(), verdict), {}));
}

ResultFile noisy_result(int scenes, int rounds, int repeats, std::mt19937_64& bits) {
    ResultFile result = result_of({});
    for (int i = 0; i < scenes; ++i) result.rows.push_back(noisy_row(fmt::format("s{}", i), rounds, repeats, bits));
    result.texts["build"] = result.texts["machine"] = "";
    return result;
}

// Compares a program with itself in 2000 simulated cases. An interval from six rounds errs with probability 2 / 2^6.
TEST(Compare, AProgramIsHardlyEverFasterOrSlowerThanItself) {
    std::mt19937_64 bits(39);
    constexpr int cases = 2000;
    const ResultFile base = noisy_result(cases, 6, 5, bits), again = noisy_result(cases, 6, 5, bits);
    const std::size_t wrong = verdicts_in(compare_results(base, again));
    EXPECT_LE(wrong, std::size_t(0.05 * cases));
    EXPECT_GT(wrong, 0u) << "else nothing was simulated";
}

TEST(Compare, LessThanSixRoundsGiveNoVerdict) {
    std::mt19937_64 bits(39);
    for (const int rounds : {1, 2, 5}) {
        const std::string text =
            compare_results(noisy_result(50, rounds, 30, bits), noisy_result(50, rounds, 30, bits));
        EXPECT_EQ(verdicts_in(text), 0u) << rounds;
        EXPECT_NE(text.find("too few rounds"), std::string::npos) << text;
    }
}

TEST(Compare, TimesOfOtherMachinesBuildsOrClocksHaveNoRatio) {
    const auto rows = [](auto change) {
        std::vector<Row> both{row("guthe", "a", 1, 2), row("cgal", "a", 1, 2)};
        for (Row& row : both) {
            row.outcome.build = "program", row.outcome.machine = "here";
            time_it(row, {{1}, {2}, {1}, {3}, {1}, {1}});
        }
        change(both[1].outcome);
        return both;
    };
    const auto said = [&](auto change) { return compare_solvers(result_of(rows(change)), "guthe", "cgal", {}); };
    EXPECT_NE(said([](Outcome&) {}).find("not separated 1 [1, 1]"), std::string::npos);
    const auto lacks = [&](auto change, const std::string& why) {
        const std::string text = said(change);
        EXPECT_NE(text.find("1 pairs without a ratio: their times are " + why), std::string::npos) << text;
        EXPECT_EQ(text.find("separated"), std::string::npos) << text;
    };
    lacks([](Outcome& o) { o.side_by_side = true; }, "run beside others");
    lacks([](Outcome& o) { o.machine = "there"; }, "of different machines");
    lacks([](Outcome& o) { o.build = "another"; }, "of different builds");
    lacks([](Outcome& o) { o.clock = "wall"; }, "by different clocks");
    // Only the builds of two results may differ.
    const auto two = [&](auto change) {
        ResultFile base = result_of(rows([](Outcome&) {})), candidate = result_of(rows(change));
        for (ResultFile* result : {&base, &candidate}) result->texts["build"] = result->texts["machine"] = "";
        for (std::size_t i : {0u, 1u}) base.rows[i].spec.identity = candidate.rows[i].spec.identity = std::to_string(i);
        return compare_results(base, candidate);
    };
    EXPECT_EQ(two([](Outcome& o) { o.build = "another"; }).find("without a ratio"), std::string::npos);
    EXPECT_NE(two([](Outcome& o) { o.machine = "there"; }).find("of different machines"), std::string::npos);
    EXPECT_NE(two([](Outcome& o) { o.clock = "wall"; }).find("by different clocks"), std::string::npos);
}

TEST(Show, SaysWhichTimesDoNotCompare) {
    std::vector<Row> rows{row("guthe", "a", 1, 2), row("cgal", "a", 1, 2), row("ohd", "a", 1, 2)};
    for (Row& row : rows) time_it(row, {{1}, {2}});
    const auto said = [&] {
        const ResultFile result = result_of(rows);
        const std::string table = show_rows(result, {0, 1, 2}, TableForm::text, {}), summary = show_summary(result, {});
        const auto line = [](const std::string& text) {
            const auto at = text.find("not all of these times are comparable");
            return at == std::string::npos ? "" : text.substr(at, text.find('\n', at) - at);
        };
        EXPECT_EQ(line(table), line(summary));
        return line(table);
    };
    EXPECT_EQ(said(), "");
    rows[1].outcome.machine = "there", rows[2].outcome.side_by_side = true;
    EXPECT_EQ(said(), "not all of these times are comparable: some are of different machines, run beside others");
    rows[1].outcome.answers.clear(), rows[1].outcome.repeats.clear();
    EXPECT_EQ(said(), "not all of these times are comparable: some are run beside others");
}

TEST(Compare, AProgramAndItsPluginsAreOneBuild) {
    std::vector<Row> rows{row("guthe", "a", 1, 2), row("mine", "a", 1, 2)};
    rows[0].outcome.build = "program";
    rows[1].outcome.build = Sha256().add("program").add("plug-in").hex();
    for (Row& row : rows) time_it(row, {{1}, {2}, {1}, {3}, {1}, {1}});
    ResultFile result = result_of(rows);
    result.texts["build"] = "program";
    result.texts["plugins"] = R"([{"file": "libmine.so", "sha256": "plug-in", "solvers": ["mine"]}])";
    EXPECT_NE(compare_solvers(result, "guthe", "mine", {}).find("not separated"), std::string::npos);
    for (const char* damaged : {"", "{", "[1]", R"([{"sha256": 1}])", "{}"}) {
        result.texts["plugins"] = damaged;
        EXPECT_NE(compare_solvers(result, "guthe", "mine", {}).find("of different builds"), std::string::npos);
    }
}

// Merged runs may number the poses of a motion differently, so rows are paired by the pose itself.
TEST(Compare, PosesArePairedByTheirNumbers) {
    std::vector<Row> rows;
    for (const char* label : {"ohd", "scan"}) {
        for (int i : {0, 1}) {
            rows.push_back(row(label, "a", 1, 2));
            rows.back().spec.pose_index = label[0] == 'o' ? i : 1 - i;
            rows.back().spec.pose.translation.x() = i;
            rows.back().outcome.bounds = {1.0 + i, 1.5 + i};
        }
    }
    EXPECT_NE(compare_solvers(result_of(rows), "ohd", "scan", {}).find("all 2 overlap"), std::string::npos);
    rows.back().spec.pose.translation.x() = 7;
    EXPECT_EQ(lines_of(compare_solvers(result_of(rows), "ohd", "scan", {}))[0].substr(0, 7), "1 pairs");
}

TEST(Compare, RowsOfDifferentProfilesAreNoPair) {
    std::vector<Row> rows;
    for (const char* label : {"ohd", "scan"}) {
        for (const char* profile : {"quick", "paper"}) {
            rows.push_back(row(label, "a", 1, 2));
            rows.back().spec.profile = profile;
        }
    }
    EXPECT_EQ(lines_of(compare_solvers(result_of(rows), "ohd", "scan", {}))[0].substr(0, 7), "2 pairs");
    rows[3].spec.profile = "paper,quick";
    EXPECT_EQ(lines_of(compare_solvers(result_of(rows), "ohd", "scan", {}))[0].substr(0, 7), "3 pairs");
}

TEST(Compare, SweepsArePairedByTheirParameters) {
    std::vector<Row> rows;
    for (const char* label : {"ohd", "scan"}) {
        for (int seed : {1, 2, 3}) rows.push_back(row(label, "a", 1, 2, fmt::format("seed={}", seed)));
    }
    rows.push_back(row("naive", "a", 1, 2));
    EXPECT_EQ(lines_of(compare_solvers(result_of(rows), "ohd", "scan", {}))[0].substr(0, 7), "3 pairs");
    EXPECT_EQ(lines_of(compare_solvers(result_of(rows), "ohd", "naive", {}))[0].substr(0, 7), "3 pairs");
    EXPECT_EQ(lines_of(compare_solvers(result_of(rows), "ohd(seed=1)", "ohd(seed=2)", {}))[0].substr(0, 7), "1 pairs");
}

TEST(Sweeps, OnlyParametersThatDifferAreNamed) {
    const std::vector<ParameterMap> swept = {{{"seed", std::int64_t(1)}, {"split", std::string("x")}},
                                             {{"seed", std::int64_t(2)}, {"split", std::string("x")}}};
    EXPECT_EQ(variant_of(swept[1], swept), "seed=2");
    EXPECT_EQ(variant_of(swept[1], {swept[1]}), "");
}

TEST(Progress, SaysWhatIsFinishedWhileAWorkerGoesOn) {
    testing::internal::CaptureStderr();
    {
        Progress progress(false, 0);
        progress.total(12);
        progress.doing("guthe on bunny");
        for (int i = 0; i < 12; ++i) progress.done(1);
    }
    const auto lines = lines_of(testing::internal::GetCapturedStderr());
    ASSERT_EQ(lines.size(), 12u);
    EXPECT_EQ(lines[4].substr(0, 7), "[5/12] ");
    EXPECT_NE(lines[4].find("guthe on bunny"), std::string::npos);
    testing::internal::CaptureStderr();
    {
        Progress progress(false, 3600);
        progress.total(12);
        progress.done(1);
        Progress(true, 0).done(1);
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "not at every case, and never where it is to be quiet";
}

// Sets one column of a row to another value.
template <class Part> void change(const Column<Part>& column, Part& part) {
    if (const auto* text = std::get_if<typename Column<Part>::Text>(&column.value)) {
        const std::string before = text->get(part);
        for (const char* other :
             {"x", R"({"a": 1})", R"({"a": "b"})", "timeout", "unsound", "number", "symmetric", "target to source"}) {
            try {
                text->set(part, other);
                if (text->get(part) != before) return;
            } catch (const std::exception&) {  // not a value of this column
            }
        }
        FAIL() << column.name;
    } else if (const auto* integer = std::get_if<typename Column<Part>::Integer>(&column.value)) {
        integer->set(part, integer->get(part) == 0 ? 1 : 0);
    } else {
        const std::vector<double> other(12, 7);
        std::get<typename Column<Part>::Real>(column.value).set(part, other.data());
    }
}

// Changes, one after another, all columns that are not among `columns`, and calls same() each time.
template <class Part, class Same>
void change_others(const Columns<Part>& all, const std::set<std::string>& columns, Part& part, const Same& same) {
    for (const Column<Part>& column : all) {
        const bool follows = std::visit([](const auto& value) { return !value.set; }, column.value);
        if (follows || columns.contains(std::string(column.name))) continue;
        change(column, part);
        same(column.name);
    }
}

TEST(Show, ReadsEveryColumnThatItShows) {
    ResultFile result = result_of({row("guthe", "needle", 1, 1.5), row("cover", "needle", 1.1, 1.2)});
    for (Row& row : result.rows) time_it(row, {{1, 2}, {2, 3}});
    const auto shown = [&] {
        std::string all;
        for (const TableForm form : {TableForm::text, TableForm::csv, TableForm::json, TableForm::markdown})
            all += show_rows(result, {0, 1}, form, {0, false});
        return all;
    };
    const std::string before = shown();
    Row& last = result.rows.back();
    const auto same = [&](std::string_view column) { EXPECT_EQ(shown(), before) << column; };
    change_others(case_columns(), shown_part().columns, last.spec, same);
    change_others(outcome_columns(), shown_part().columns, last.outcome, same);
    change_others(check_columns(), shown_part().columns, last.check, same);
    change_others(row_columns(), shown_part().columns, last, same);
    last.spec.tolerance = 1;
    EXPECT_NE(shown(), before);
}

TEST(Compare, ReadsEveryColumnThatItComparesBy) {
    ResultFile result = result_of({row("guthe", "needle", 1, 1.5), row("cover", "needle", 1.1, 1.2)});
    result.texts.insert({{"build", "b"}, {"machine", "m"}});
    for (Row& row : result.rows) time_it(row, {{1, 2}, {2, 3}});
    const ResultFile base = result;
    const auto compared = [&] {
        return compare_results(base, result) + compare_solvers(result, "guthe", "cover", {0, false});
    };
    const std::string before = compared();
    const auto same = [&](std::string_view column) { EXPECT_EQ(compared(), before) << column; };
    Row& last = result.rows.back();
    change_others(case_columns(), compared_part().columns, last.spec, same);
    change_others(outcome_columns(), compared_part().columns, last.outcome, same);
    change_others(check_columns(), compared_part().columns, last.check, same);
    change_others(row_columns(), compared_part().columns, last, same);
    last.outcome.bounds = {0, 1};
    EXPECT_NE(compared(), before);
}

ModelRecord model_record(const char* name, const char* sha256) {
    ModelRecord model;
    model.name = name;
    model.sha256 = sha256;
    return model;
}

TEST(Compare, CountsTheRowsOfOtherShapes) {
    ResultFile base = result_of({row("guthe", "a", 1, 2), row("guthe", "b", 1, 2), row("guthe", "c", 1, 2)});
    base.texts.insert({{"build", ""}, {"machine", ""}});
    for (const char* name : {"kept", "half", "only here"}) base.models.push_back(model_record(name, name));
    base.rows[0].spec.target = base.rows[1].spec.source = "half";
    for (Row& row : base.rows) row.spec.identity = row.spec.scene;
    EXPECT_EQ(compare_results(base, base).find("not compared"), std::string::npos);
    ResultFile candidate = base;
    candidate.models[1].sha256 = "of another CGAL";
    candidate.models[2].name = "only there";
    candidate.rows[0].spec.identity = candidate.rows[1].spec.identity = "another";
    candidate.rows.push_back(candidate.rows[1]);
    EXPECT_EQ(unlike_models(base, candidate), std::set<std::string>{"half"});
    const std::string text = compare_results(base, candidate);
    EXPECT_NE(text.find("1 cases in both, 2 only in the first, 3 only in the second\n"), std::string::npos) << text;
    EXPECT_NE(text.find("2 and 3 cases of half\n"), std::string::npos) << text;
    candidate.rows.resize(2);
    EXPECT_THROW(compare_results(base, candidate), InputError);
}

TEST(ReadPart, ReadsTheColumnsAndTimesAskedFor) {
    ResultFile result;
    describe_run(result, Plan{}, "", "");
    result.rows = {row("guthe", "needle", 1, 1.5), row("cover", "needle", 1.1, 1.2)};
    result.texts["profile"] = "paper";
    result.rows[1].spec.profile = "";
    time_it(result.rows[1], {{1, 2}, {2, 3}});
    result.models.push_back(model_record("needle", "its hash"));
    const TemporaryFolder folder;
    const auto file = folder.path() / "result.h5";
    write_result(file, result);
    const ResultFile part = read_part(file, {{"label", "upper"}, true});
    EXPECT_EQ(part.texts, result.texts);
    ASSERT_EQ(part.rows.size(), 2u);
    EXPECT_EQ(part.rows[1].spec.label, "cover");
    EXPECT_EQ(part.rows[1].spec.profile, "paper");
    EXPECT_EQ(part.rows[1].spec.solver, "");
    EXPECT_EQ(part.rows[1].outcome.bounds.upper, 1.2);
    EXPECT_TRUE(std::isnan(part.rows[1].outcome.bounds.lower));
    EXPECT_EQ(part.rows[1].outcome.repeats.size(), 4u);
    EXPECT_EQ(part.rows[1].outcome.answers.size(), 2u);
    EXPECT_EQ(part.rows[1].outcome.preparation.size(), 2u);
    EXPECT_TRUE(read_part(file, {{"label"}}).rows[1].outcome.repeats.empty());
    EXPECT_TRUE(part.models.empty());
    EXPECT_EQ(read_part(file, {{}, false, true}).models.at(0).sha256, "its hash");
}

}  // namespace
}  // namespace hausbench
