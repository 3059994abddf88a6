// A run adds to an earlier result, and replaces only the rows that it was asked for.
#include "harness/run/earlier.h"
#include "harness/record/profiles.h"

#include "algorithms/error.h"
#include "harness/run/journal.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>

namespace hausbench {
namespace {

constexpr const char* experiment = R"(
title = "test"
tolerances = [1e-3]
[[scene]]
name = "s"
source = "a"
target = "b"
[[scene]]
name = "t"
source = "c"
target = "b"
[[solver]]
name = "naive"
[[solver]]
name = "scan"
[[solver]]
name = "ohd"
profiles = ["paper"]
)";

Shape no_shape(const ModelRecord& record) { throw InputError("no shape of " + record.name); }

class Earlier : public testing::Test {
protected:
    Earlier() { ask(experiment); }

    // Sets the text of the experiment.
    void ask(const std::string& text) {
        std::ofstream(file()) << text;
        plan_.experiment = read_experiment(file(), "quick");
    }

    std::filesystem::path file() const { return folder_.path() / "test.toml"; }

    static std::vector<ModelRecord> models() {
        return {model("a", "a1"), model("b", "b1"), model("c", "c1"), model("unused", "u")};
    }

    // Returns a row of this solver and scene. If even the profile `paper`, which has all solvers, does
    // not request such a case, the row belongs to none.
    Row row(const std::string& label, const std::string& scene, const std::string& profile, double lower) const {
        Row row;
        for (Case& c : cases_as_recorded(read_experiment(file(), "paper"), models(), no_shape).cases)
            if (c.label == label && c.scene == scene) row.spec = std::move(c);
        if (row.spec.label.empty()) {
            row.spec.solver = row.spec.label = label;
            row.spec.scene = scene;
            row.spec.source = scene == "s" ? "a" : "c", row.spec.target = "b";
            row.spec.source_hash = row.spec.source + "1", row.spec.target_hash = "b1";
            row.spec.identity = identify(row.spec);
        }
        row.spec.profile = profile;
        row.outcome.status = RowStatus::ok;
        row.outcome.bounds = {lower, lower};
        return row;
    }

    static ModelRecord model(const std::string& name, const std::string& hash) {
        ModelRecord record;
        record.name = name, record.sha256 = hash, record.kind = "points", record.diagonal = record.longest_side = 2;
        return record;
    }

    // Adds rows of a run, with lower bound 2; earlier rows have another one.
    void run(const std::vector<std::pair<std::string, std::string>>& spec, bool whole) {
        plan_.whole = whole;
        for (const auto& [label, scene] : spec) {
            result_.rows.push_back(row(label, scene, "quick", 2));
            plan_.cases.push_back(result_.rows.back().spec);
        }
        result_.models = {model("a", "a1"), model("b", "b1")};
    }

    void before(std::vector<Row> rows) {
        before_.rows = std::move(rows);
        before_.models = models();
    }

    std::vector<std::string> keep() {
        return keep_earlier(
            result_, before_, plan_, [this](const Experiment&) { return shape_; }, places_);
    }

    std::multiset<std::string> rows() const {
        std::multiset<std::string> all;
        for (const Row& r : result_.rows)
            all.insert(r.spec.label + " " + r.spec.scene + " " + r.spec.profile + " " +
                       std::to_string(int(r.outcome.bounds.lower)));
        return all;
    }

    TemporaryFolder folder_;
    Plan plan_;
    ResultFile result_, before_;
    std::vector<std::size_t> places_;
    ShapeOf shape_ = no_shape;
};

using Rows = std::multiset<std::string>;

TEST_F(Earlier, APartReplacesItsRowsAlone) {
    before({row("naive", "s", "quick", 1), row("scan", "s", "quick", 1), row("naive", "t", "quick", 1)});
    run({{"scan", "s"}}, false);
    EXPECT_TRUE(keep().empty());
    EXPECT_EQ(rows(), (Rows{"naive s quick 1", "naive t quick 1", "scan s quick 2"}));
    EXPECT_EQ(places_, (std::vector<std::size_t>{1, 0, 2})) << "it stands where it stood";
    ASSERT_EQ(result_.models.size(), 3u) << "of what stays, and no other";
    EXPECT_EQ(result_.models.back().name, "c");
}

TEST_F(Earlier, ARunOfTheWholeReplacesAllOfItsProfile) {
    Row other = row("scan", "s", "quick", 1);
    other.spec.tolerance = 0.5;  // no longer asked for
    other.spec.identity = identify(other.spec);
    before({row("naive", "s", "quick", 1), other, row("ohd", "s", "paper", 1)});
    run({{"naive", "s"}, {"scan", "s"}}, true);
    EXPECT_TRUE(keep().empty());
    EXPECT_EQ(rows(), (Rows{"naive s quick 2", "scan s quick 2", "ohd s paper 1"}));
}

TEST_F(Earlier, ACaseOfTwoProfilesIsOneRow) {
    before({row("naive", "s", "paper,quick", 1), row("scan", "s", "paper", 1), row("naive", "t", "paper,quick", 1)});
    run({{"naive", "s"}, {"scan", "s"}}, true);
    keep();
    EXPECT_EQ(rows(), (Rows{"naive s paper,quick 2", "scan s paper,quick 2", "naive t paper 1"}));
}

TEST_F(Earlier, WhatNothingAsksForGoesAndIsSaid) {
    before({row("inc", "s", "quick", 1), row("ohd", "s", "quick", 1), row("ohd", "s", "paper", 1),
            row("naive", "t", "gone", 1)});
    run({{"naive", "s"}}, false);
    const auto said = keep();
    EXPECT_EQ(rows(), (Rows{"naive s quick 2", "ohd s paper 1"}));
    ASSERT_EQ(said.size(), 1u);
    EXPECT_EQ(said[0].substr(0, 15), "3 earlier rows ");
}

TEST_F(Earlier, AnEditedExperimentNoLongerAsksForARow) {
    std::vector<Row> rows_before;
    for (int i = 0; i < 6; ++i) rows_before.push_back(row("scan", "s", "quick", i));
    rows_before[1].spec.tolerance = 0.5;
    rows_before[2].spec.tolerance_of = "absolute";
    rows_before[3].spec.solver = "ohd";
    rows_before[4].spec.source = "c", rows_before[4].spec.source_hash = "c1";
    rows_before[5].spec.quantity = Quantity::symmetric;
    for (Row& changed : rows_before) changed.spec.identity = identify(changed.spec);
    before(rows_before);
    run({{"naive", "s"}}, false);
    const auto said = keep();
    EXPECT_EQ(rows(), (Rows{"naive s quick 2", "scan s quick 0"}));
    ASSERT_EQ(said.size(), 1u);
    EXPECT_EQ(said[0].substr(0, 15), "5 earlier rows ");
}

// After an edit of the experiment, a run of `naive` alone keeps the other solver's rows that are still requested.
TEST_F(Earlier, ARowStaysIfAndOnlyIfItsIdentityIsAskedFor) {
    const std::string solver = "\n[[solver]]\nname = \"naive\"\n[[solver]]\nname = \"guthe\"\n";
    const auto text = [&](const std::string& top, const std::string& scene, const std::string& of_solver) {
        return "title = \"test\"\ntolerances = [1e-3]\n" + top +
               "\n[[scene]]\nname = \"s\"\nsource = \"a\"\ntarget = \"b\"\n" + scene + solver + of_solver;
    };
    const std::string move =
        "motion = { kind = 'translation', from = [0, 0, 0], to = [1, 0, 0], steps = 2, of = 'absolute' }\n";
    const std::string further =
        "motion = { kind = 'translation', from = [0, 0, 0], to = [2, 0, 0], steps = 2, of = 'absolute' }\n";
    struct Edit {
        std::string before, now;
        std::size_t rows, stay;
    };
    const std::string usual = text("", "", "");
    const std::vector<Edit> edits = {
        {usual, usual, 1, 1},
        {text("", "tolerances = [1e-2, 1e-4]\n", ""), text("", "tolerances = [1e-2, 1e-4]\n", ""), 2, 2},
        {text("", "tolerances = [1e-2, 1e-4]\n", ""), text("", "tolerances = [1e-2, 1e-5]\n", ""), 2, 1},
        {text("", "", "parameters = { split = 'midpoint' }\n"),
         text("", "", "parameters = { split = 'longest_edge' }\n"), 1, 0},
        {text("", "", "parameters = { split = ['midpoint', 'longest_edge'] }\n"),
         text("", "", "parameters = { split = 'longest_edge' }\n"), 2, 1},
        {usual, text("floor = 0.1\n", "", ""), 1, 0},
        {usual, text("cutoff = 0.1\n", "", ""), 1, 0},
        {usual, text("budget = 10\n", "", ""), 1, 0},
        {usual, text("[limits]\ncase_seconds = 7\n", "", ""), 1, 0},
        {text("", move, ""), text("", move, ""), 2, 2},
        {text("", move, ""), text("", further, ""), 2, 1},
        {text("threads = 2\n", "", "[[solver]]\nname = \"cover\"\n"),
         text("threads = 1\n", "", "[[solver]]\nname = \"cover\"\n"), 2, 1},
    };
    shape_ = [](const ModelRecord&) -> Shape { return PointSet{Points(Points::Zero(1, 3))}; };
    for (const Edit& edit : edits) {
        SCOPED_TRACE(edit.before + "----\n" + edit.now);
        plan_ = {}, result_ = {}, before_ = {}, places_ = {};
        ask(edit.before);
        std::vector<Row> earlier;
        for (Case& c : cases_as_recorded(plan_.experiment, models(), shape_).cases) {
            if (c.label == "naive") continue;
            earlier.push_back({std::move(c), {}, {}});
        }
        ASSERT_EQ(earlier.size(), edit.rows);
        before(earlier);
        ask(edit.now);
        run({{"naive", "s"}}, false);
        keep();
        EXPECT_EQ(result_.rows.size(), 1 + edit.stay);
    }
}

// The poses depend on the shape. If it is missing, the row may still be requested, so it stays.
TEST_F(Earlier, RowsOfAMotionStayWhereTheirModelIsNotThere) {
    const std::string text = std::string(experiment) +
                             "[[scene]]\nname = 'r'\nsource = 'a'\ntarget = 'b'\n"
                             "motion = { kind = 'rotation', axis = [0, 0, 1], degrees = 90, steps = 2 }\n";
    ask(text);
    Row moved = row("scan", "r", "quick", 1);
    moved.spec.pose.translation = Vec3(1, 0, 0);
    moved.spec.identity = identify(moved.spec);
    before({moved});
    run({{"naive", "s"}}, false);
    EXPECT_TRUE(keep().empty());
    EXPECT_EQ(rows(), (Rows{"naive s quick 2", "scan r quick 1"}));
}

TEST_F(Earlier, WhatTheExperimentSaysOfARowIsOfToday) {
    before({row("scan", "t", "quick", 1)});
    before_.rows[0].spec.note = "an old remark";
    before_.rows[0].spec.exact = 7;
    run({{"naive", "s"}}, false);
    keep();
    ASSERT_EQ(result_.rows.size(), 2u);
    EXPECT_EQ(result_.rows[1].spec.note, "");
    EXPECT_TRUE(std::isnan(result_.rows[1].spec.exact));
}

TEST_F(Earlier, ACaseThatARunDidNotComeToKeepsItsOutcome) {
    before({row("naive", "s", "paper,quick", 1), row("scan", "s", "quick", 1)});
    before_.rows[0].outcome.reason = "kept";
    run({{"naive", "s"}, {"scan", "s"}}, true);
    result_.rows[0].outcome = {};
    result_.rows[0].outcome.reason = not_run_yet;
    const auto said = keep();
    EXPECT_EQ(rows(), (Rows{"naive s paper,quick 1", "scan s quick 2"}));
    EXPECT_EQ(result_.rows[0].outcome.reason, "kept");
    ASSERT_EQ(said.size(), 1u);
    EXPECT_EQ(said[0].substr(0, 29), "1 rows were not measured agai");
}

TEST_F(Earlier, RowsOfOtherBytesGo) {
    before({row("scan", "s", "quick", 1)});
    before_.rows[0].spec.target_hash = "b0";
    run({{"naive", "s"}}, false);
    const auto said = keep();
    EXPECT_EQ(rows(), (Rows{"naive s quick 2"}));
    ASSERT_EQ(said.size(), 1u);
    EXPECT_NE(said[0].find("model 'b'"), std::string::npos);
}

TEST_F(Earlier, RowsOfAnotherBuildStayAndAreSaid) {
    before({row("scan", "s", "quick", 1)});
    before_.rows[0].outcome.build = "another";
    run({{"naive", "s"}}, false);
    const auto said = keep();
    EXPECT_EQ(rows(), (Rows{"naive s quick 2", "scan s quick 1"}));
    ASSERT_EQ(said.size(), 1u);
    EXPECT_NE(said[0].find("another build"), std::string::npos);
}

TEST_F(Earlier, TheLedgerFollowsItsRows) {
    before({row("naive", "s", "quick", 1), row("scan", "s", "quick", 1), row("ohd", "s", "paper", 1)});
    const auto entry = [](const char* subject, const char* profile) {
        return LedgerEntry{"not_run", subject, "all cases", "because", 1, unknown, profile};
    };
    before_.ledger = {entry("naive on s", "quick"), entry("scan on s", "quick"), entry("ohd on s", "paper"),
                      entry("ohd on s", "gone")};
    run({{"scan", "s"}}, false);
    keep();
    ASSERT_EQ(result_.ledger.size(), 2u);
    EXPECT_EQ(result_.ledger[0].subject, "naive on s");
    EXPECT_EQ(result_.ledger[1].profile, "paper");
}

TEST(Profiles, AreAList) {
    EXPECT_TRUE(share_profile("paper,quick", "quick"));
    EXPECT_FALSE(share_profile("paper,quick2", "quick"));
    EXPECT_EQ(joined_profiles("quick", "paper,quick"), "paper,quick");
}

// `run --fresh` of a part forgets that part permanently.
TEST(Journal, ForgetsWhatItIsToldTo) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "a.journal";
    Outcome outcome;
    outcome.status = RowStatus::ok;
    {
        Journal journal(file);
        for (const char* identity : {"a", "b"}) {
            for (int round : {0, 1}) journal.append({identity, round}, outcome);
        }
        journal.forget({"a", "c"});
        EXPECT_EQ(journal.outcomes().size(), 2u);
        journal.append({"c", 0}, outcome);
    }
    {
        Journal journal(file);
        EXPECT_EQ(journal.outcomes().size(), 3u);
        EXPECT_FALSE(journal.outcomes().contains({"a", 0}));
        EXPECT_TRUE(journal.outcomes().contains({"c", 0})) << "it came after";
        journal.forget({"b", "c"});
        EXPECT_LT(std::filesystem::file_size(file), 200u) << "nothing is left to keep";
    }
    EXPECT_TRUE(Journal(file).outcomes().empty());
    std::ofstream(file) << "not a journal\n";
    EXPECT_THROW(Journal{file}, InputError);
    EXPECT_TRUE(Journal(file, true).outcomes().empty());
}

}  // namespace
}  // namespace hausbench
