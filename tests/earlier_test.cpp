// A run adds to the result that is there, and replaces only what it was asked for.
#include "run/earlier.h"
#include "record/profiles.h"

#include "error.h"
#include "run/journal.h"
#include "temporary_folder.h"

#include <gtest/gtest.h>

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

class Earlier : public testing::Test {
protected:
    Earlier() {
        std::ofstream(folder_.path() / "test.toml") << experiment;
        plan_.experiment = read_experiment(folder_.path() / "test.toml", "quick");
    }

    static Row row(const std::string& label, const std::string& scene, const std::string& profile, double lower) {
        Row row;
        row.asked.solver = row.asked.label = label;
        row.asked.scene = scene;
        row.asked.source = scene == "s" ? "a" : "c", row.asked.target = "b";
        row.asked.source_hash = row.asked.source + "1", row.asked.target_hash = "b1";
        row.asked.tolerance = 1e-3;
        row.asked.tolerance_of = "diagonal";
        row.asked.identity = identify(row.asked);
        row.asked.profile = profile;
        row.outcome.status = RowStatus::ok;
        row.outcome.bounds = {lower, lower};
        return row;
    }

    static ModelRecord model(const std::string& name, const std::string& hash) {
        ModelRecord record;
        record.name = name, record.sha256 = hash;
        return record;
    }

    // What a run of these has measured: lower bound 2.
    void run(const std::vector<std::pair<std::string, std::string>>& asked, bool whole) {
        plan_.whole = whole;
        for (const auto& [label, scene] : asked) {
            result_.rows.push_back(row(label, scene, "quick", 2));
            plan_.cases.push_back(result_.rows.back().asked);
        }
        result_.models = {model("a", "a1"), model("b", "b1")};
    }

    void before(std::vector<Row> rows) {
        before_.rows = std::move(rows);
        before_.models = {model("a", "a1"), model("b", "b1"), model("c", "c1"), model("unused", "u")};
    }

    std::vector<std::string> keep() { return keep_earlier(result_, before_, plan_, places_); }

    std::multiset<std::string> rows() const {
        std::multiset<std::string> all;
        for (const Row& r : result_.rows)
            all.insert(r.asked.label + " " + r.asked.scene + " " + r.asked.profile + " " +
                       std::to_string(int(r.outcome.bounds.lower)));
        return all;
    }

    TemporaryFolder folder_;
    Plan plan_;
    ResultFile result_, before_;
    std::vector<std::size_t> places_;
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
    other.asked.tolerance = 0.5;  // no longer asked for
    other.asked.identity = identify(other.asked);
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
    rows_before[1].asked.tolerance = 0.5;
    rows_before[2].asked.tolerance_of = "absolute";
    rows_before[3].asked.solver = "ohd";
    rows_before[4].asked.source = "c", rows_before[4].asked.source_hash = "c1";
    rows_before[5].asked.quantity = Quantity::symmetric;
    before(rows_before);
    run({{"naive", "s"}}, false);
    const auto said = keep();
    EXPECT_EQ(rows(), (Rows{"naive s quick 2", "scan s quick 0"}));
    ASSERT_EQ(said.size(), 1u);
    EXPECT_EQ(said[0].substr(0, 15), "5 earlier rows ");
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
    before_.rows[0].asked.target_hash = "b0";
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

// `run --fresh` of a part forgets that part, for good.
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
