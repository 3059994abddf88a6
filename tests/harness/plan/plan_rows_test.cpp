// Plans made from experiment files: poses of both shapes, both quantities, and chains of warm cases.
#include "harness/plan/plan.h"

#include "algorithms/error.h"
#include "algorithms/registry.h"
#include "harness/run/work_order.h"
#include "tests/support/temporary_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <set>

namespace hausbench {
namespace {

// A solver that accepts every scene; plans need it, but never run it.
class Idle : public Solver {
    void prepare(const Scene&, const Prepared&) override {}
    Result solve(const Query&, State*, Trace&) const override { return {}; }
};

SolverEntry idle(const char* name, bool exact, bool points = true, bool guided = false) {
    SolverInfo info{
        .name = name, .title = name, .paper = "", .source = {true, true, true}, .target = {true, true, true}};
    info.abilities.insert({Ability::warm, Ability::traces});
    info.ignores_tolerance = exact;
    info.source.points = points;
    if (!guided) info.abilities.insert(Ability::coarser_answers);
    return {info, [](const Options&) -> std::unique_ptr<Solver> { return std::make_unique<Idle>(); }};
}

class PlanRows : public testing::Test {
protected:
    static void SetUpTestSuite() {
        add_solvers({idle("idle", false), idle("idle_exact", true), idle("idle_without_points", true, false),
                     idle("idle_guided", false, true, true)},
                    "test");
    }

    std::filesystem::path write(const std::string& name, const std::string& text) const {
        const auto file = folder_.path() / name;
        std::ofstream(file) << text;
        return file;
    }
    Plan plan(const std::string& top, const std::string& scene, const std::string& solver) const {
        const auto manifest =
            write("manifest.toml",
                  "[model.ball]\nsource = 'generated'\nrecipe = 'icosphere'\nlevel = 1\nradius = 1.0\n"
                  "[model.half]\nsource = 'derived'\nfrom = 'ball'\noperation = 'scale'\nfactor = 0.5\n"
                  "[model.cloud]\nsource = 'generated'\nrecipe = 'uniform_points'\ncount = 9\nseed = 1\n");
        const auto file = write("s.toml", fmt::format("title = 't'\ntolerances = [0.1, 0.01]\n{}\n"
                                                      "[[scene]]\nname = 's'\nsource = 'ball'\ntarget = 'half'\n{}\n"
                                                      "[[solver]]\nname = 'idle'\n{}\n",
                                                      top, scene, solver));
        return make_plan(read_experiment(file, "quick"), Catalogue(manifest, folder_.path() / "cache", ""), {},
                         [this](const std::string& name, std::size_t before, std::size_t of) {
                             said_.push_back(fmt::format("{} {}/{}", name, before, of));
                         });
    }
    // Plans a matrix scene: each source with each target or, by default, a search for its nearest target.
    Plan matrix_plan(const std::string& top, const std::string& sources, const std::string& targets,
                     const std::string& solver = "", const std::string& search = "search = 'nearest'") const {
        return plan(top,
                    fmt::format("[[scene]]\nname = 'm'\nsources = [{}]\n{}\n{}", sources,
                                targets.empty() ? "" : "targets = [" + targets + "]", search),
                    fmt::format("scenes = ['m']\n{}", solver));
    }
    void refuses(const std::string& top, const std::string& scene, const std::string& solver,
                 const std::vector<std::string>& words) const {
        try {
            plan(top, scene, solver);
            FAIL() << scene << solver;
        } catch (const InputError& error) {
            for (const std::string& word : words)
                EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
        }
    }

    mutable std::vector<std::string> said_;  // progress messages about models being made

private:
    TemporaryFolder folder_;
};

std::set<std::string> identities(const Plan& plan) {
    std::set<std::string> all;
    for (const Case& spec : plan.cases) all.insert(spec.identity);
    return all;
}

TEST_F(PlanRows, SaysWhichModelItMakesAndHowManyAreLeft) {
    plan("", "", "");
    EXPECT_EQ(said_, (std::vector<std::string>{"ball 0/2", "half 1/2"}));
}

// All options run with a seed before the next seed begins.
TEST_F(PlanRows, EachSeedRunsAllOptionsBeforeTheNextSeedBegins) {
    const Plan swept = plan("", "[[scene]]\nname = 'c'\nsource = 'cloud'\ntarget = 'cloud'\n",
                            "[[solver]]\nname = 'ohd'\nscenes = ['c']\n"
                            "parameters = { lambda = [0.1, 0.2, 0.5], seed = [1, 2, 3] }\n"
                            "[[solver]]\nname = 'ohd'\nlabel = 'all'\nscenes = ['c']\n"
                            "parameters = { culling = 'none', seed = [1, 2, 3] }\n"
                            "[[solver]]\nname = 'scan'\nscenes = ['c']\n");
    std::vector<std::string> order;
    for (const Job& job : swept.jobs) {
        const Case& first = swept.cases[job.cases.front()];
        if (first.scene != "c" || first.solver == "idle") continue;
        order.push_back(first.solver == "scan"
                            ? "scan"
                            : fmt::format("{} {} {}", first.label, to_string(first.options.at("lambda")),
                                          to_string(first.options.at("seed"))));
    }
    const std::vector<std::string> expected{
        "scan",      "all 0.01 1", "ohd 0.5 1", "ohd 0.2 1",  "ohd 0.1 1",  // every other seed in reverse order
        "ohd 0.1 2", "ohd 0.2 2",  "ohd 0.5 2", "all 0.01 2", "all 0.01 3", "ohd 0.5 3", "ohd 0.2 3", "ohd 0.1 3"};
    EXPECT_EQ(order, expected);
}

TEST_F(PlanRows, BothShapesMove) {
    const std::string a = "motion = { kind = 'translation', from = [0, 0, 0], to = [2, 0, 0], steps = 3 }\n";
    const std::string b = "target_motion = { kind = 'translation', from = [0, 0, 0], to = [0, 2, 0], steps = 3 }\n";
    const Plan still = plan("", "", ""), a_moves = plan("", a, ""), b_moves = plan("", b, ""),
               both = plan("", a + b, "");
    ASSERT_EQ(both.cases.size(), 6u);  // three poses, two tolerances
    const double whole = both.cases[0].source_diagonal;
    for (std::size_t i : {0u, 2u, 4u}) {
        const double s = double(i / 2);
        EXPECT_EQ(both.cases[i].pose_index, int(i / 2));
        EXPECT_EQ(both.cases[i].pose.translation, Vec3(s * whole, 0, 0));
        EXPECT_NEAR(both.cases[i].target_pose.translation.y(), s * whole / 2, 1e-15);  // B's diagonal is whole / 2
        EXPECT_TRUE(a_moves.cases[i].target_pose.is_identity());
        EXPECT_TRUE(b_moves.cases[i].pose.is_identity());
        EXPECT_EQ(b_moves.cases[i].target_pose.translation, both.cases[i].target_pose.translation);
    }
    const QuerySet &two = both.jobs.at(0).pairs.at(0).queries, &b_alone = b_moves.jobs.at(0).pairs.at(0).queries;
    EXPECT_TRUE(two.moves && two.target_moves && !b_alone.moves && b_alone.target_moves);
    EXPECT_FALSE(still.jobs.at(0).pairs.at(0).queries.moves);
    // The first pose is the pose of the static scene; all others differ.
    for (const Plan* moving : {&a_moves, &b_moves, &both}) {
        EXPECT_EQ(moving->cases[0].identity, still.cases[0].identity);
        EXPECT_EQ(identities(*moving).size(), 6u);
    }
    std::set<std::string> all;
    for (const Plan* moving : {&a_moves, &b_moves, &both}) all.merge(identities(*moving));
    EXPECT_EQ(all.size(), 2u + 3 * 4);
}

TEST_F(PlanRows, MotionsHaveAsManyPosesOrOneIsStatic) {
    const std::string three = "motion = { kind = 'rotation', axis = [0, 0, 1], degrees = 90, steps = 3 }\n";
    const std::string two = "target_motion = { kind = 'rotation', axis = [0, 0, 1], degrees = 90, steps = 2 }\n";
    refuses("", three + two, "", {"s.toml:9:", "'motion' has 3 poses", "'target_motion' 2", "static"});
    write("two.txt", "1 0 0 0 1 0 0 0 1 0 0 0\n1 0 0 0 1 0 0 0 1 5 0 0\n");
    refuses("", three + "target_motion = { kind = 'poses', file = 'two.txt' }\n", "", {"s.toml:9:", "3", "2"});
    EXPECT_EQ(plan("", three + "target_motion = { kind = 'static' }\n", "").cases.size(), 6u);
    refuses("", two + "exact = 1\n", "", {"'exact'", "one pose"});
    refuses("", "target_motion = 3", "", {"'target_motion' must be a table"});
}

TEST_F(PlanRows, ATraceHasTheCoarserAnswersUnlessTheToleranceGuides) {
    const auto run = [&](const std::string& top, const std::string& solver) {
        std::size_t cases = 0;
        for (const Job& job : plan(top, "", solver).jobs) cases += job.cases.size();
        return cases;
    };
    const std::string guided = "[[solver]]\nname = 'idle_guided'";
    EXPECT_EQ(run("", ""), 2u);
    EXPECT_EQ(run("trace = true", ""), 1u);
    EXPECT_EQ(run("trace = true", guided), 3u);  // one case of `idle`, both of the guided solver
    EXPECT_EQ(run("", guided), 4u);
}

TEST_F(PlanRows, AWarmChainIsAJobWithTheCasesBefore) {
    const std::string three = "motion = { kind = 'rotation', axis = [0, 0, 1], degrees = 90, steps = 3 }\n";
    const Plan cold = plan("trace = true", three, ""), warm = plan("trace = true", three, "warm = true");
    ASSERT_EQ(warm.cases.size(), 6u);
    EXPECT_EQ(cold.jobs.size(), 1u);
    ASSERT_EQ(warm.jobs.size(), 2u);  // one per tolerance
    for (const Job& job : warm.jobs) {
        ASSERT_EQ(job.cases.size(), 3u);
        EXPECT_EQ(job.pairs.at(0).queries.count, 3u);
        EXPECT_EQ(job.pairs.at(0).queries.finest_tolerance, warm.cases[job.cases[0]].resolved_tolerance().value);
        std::string before;
        for (std::size_t p = 0; p < 3; ++p) {
            const Case& spec = warm.cases[job.cases[p]];
            EXPECT_EQ(spec.pose_index, int(p));
            EXPECT_EQ(spec.tolerance, warm.cases[job.cases[0]].tolerance);
            EXPECT_TRUE(spec.warm);
            EXPECT_EQ(spec.chain, before);
            before = spec.identity;
        }
    }
    // Warm rows are never derived from rows of finer tolerances, not even for an exact solver.
    EXPECT_EQ(cold.traced.size(), 3u);
    EXPECT_TRUE(warm.traced.empty());
    EXPECT_TRUE(plan("", three, "warm = true\n[[solver]]\nname = 'idle_exact'\nwarm = true").traced.empty());
    // Warm and cold cases have different identities, even the first of a chain.
    std::set<std::string> all = identities(cold);
    all.merge(identities(warm));
    EXPECT_EQ(all.size(), 12u);
    // The identity includes the earlier poses: the same pose reached by another path is another case.
    Case last = warm.cases[warm.jobs[0].cases[2]];
    last.chain = warm.cases[warm.jobs[0].cases[0]].identity;
    EXPECT_NE(identify(last), last.identity);
}

TEST_F(PlanRows, OfEitherQuantity) {
    const Plan h = plan("trace = true", "exact = 3", ""),
               both = plan("trace = true\nquantity = 'symmetric'", "exact = 3", ""),
               mixed = plan("trace = true", "exact = 3", "[[solver]]\nname = 'idle_exact'\nquantity = 'symmetric'");
    for (const Case& spec : h.cases) EXPECT_TRUE(spec.quantity == Quantity::directed && spec.exact == 3);
    for (const Case& spec : both.cases) EXPECT_TRUE(spec.quantity == Quantity::symmetric && spec.exact == 3);
    EXPECT_EQ(mixed.cases[0].identity, h.cases[0].identity);
    EXPECT_NE(both.cases[0].identity, h.cases[0].identity);
    // `exact` states the distance only for the experiment's own quantity, so other cases have NaN.
    for (std::size_t i : {2u, 3u})
        EXPECT_TRUE(mixed.cases[i].quantity == Quantity::symmetric && std::isnan(mixed.cases[i].exact));
    // Rows of H have no trace to derive coarser answers from; an exact solver needs none.
    EXPECT_EQ(h.traced.size(), 1u);
    EXPECT_TRUE(both.traced.empty());
    EXPECT_EQ(mixed.traced.size(), 2u);
    // A solver without symmetric answers solves both directions for H, so it must accept both orders of the shapes.
    const auto to_cloud = [&](const char* quantity) {
        const Plan plan = this->plan(quantity, "[[scene]]\nname = 'c'\nsource = 'ball'\ntarget = 'cloud'",
                                     "scenes = ['s']\n[[solver]]\nname = 'idle_without_points'\nscenes = ['c']");
        return plan.decided.empty() ? "" : plan.decided.begin()->second.reason;
    };
    EXPECT_EQ(to_cloud(""), "");
    EXPECT_EQ(to_cloud("quantity = 'symmetric'"),
              "solver 'idle_without_points' takes no points as source, as H(A,B) asks for");
    refuses("quantity = 'symetric'", "", "", {"s.toml:3:", "'quantity'", "did you mean 'symmetric'"});
    refuses("", "", "quantity = 'h'",
            {"'quantity'", "directed (h), symmetric (H), penetration (depth) or distribution"});
}

TEST_F(PlanRows, OnlySolversThatCarryAStateAreWarm) {
    refuses("", "", "[[solver]]\nname = 'naive'\nwarm = true",
            {"s.toml:", "'warm'", "'naive' carries nothing from one pose to the next"});
    refuses("", "", "warm = 1", {"'warm' must be true or false"});
    EXPECT_EQ(plan("", "", "warm = false").cases[0].identity, plan("", "", "").cases[0].identity);
}

TEST_F(PlanRows, InASearchTheTargetsOfASourceAreOneChain) {
    const Plan search = matrix_plan("", "'ball', 'half', 'cloud'", ""),
               matrix = matrix_plan("", "'ball', 'half', 'cloud'", "", "", "");
    ASSERT_EQ(matrix.cases.size(), 2u * 9);
    ASSERT_EQ(search.cases.size(), 2u * 6);  // no shape is its own target
    ASSERT_EQ(matrix.jobs.size(), 1u);
    ASSERT_EQ(search.jobs.size(), 2u);  // one per tolerance
    const std::vector<std::pair<std::string, std::string>> pairs = {
        {"ball", "half"}, {"ball", "cloud"}, {"half", "ball"}, {"half", "cloud"}, {"cloud", "ball"}, {"cloud", "half"}};
    std::set<std::string> of_matrix = identities(matrix), heads;
    for (const Job& job : search.jobs) {
        ASSERT_EQ(job.cases.size(), 6u);
        ASSERT_EQ(job.pairs.size(), 6u);
        EXPECT_TRUE(job.exponent);
        for (std::size_t i = 0; i < 6; ++i) {
            const Case& spec = search.cases[job.cases[i]];
            EXPECT_EQ(std::pair(spec.source, spec.target), pairs[i]);
            EXPECT_EQ(job.pairs[i].cases, 1u);
            EXPECT_EQ(spec.tolerance, search.cases[job.cases[0]].tolerance);
            EXPECT_FALSE(spec.warm);
            EXPECT_EQ(spec.chain, i % 2 == 0 ? "" : search.cases[job.cases[i - 1]].identity);
            // Only the first case of a chain equals a case of the matrix: later ones depend on earlier answers.
            EXPECT_EQ(of_matrix.contains(spec.identity), i % 2 == 0);
        }
    }
    EXPECT_EQ(identities(search).size(), 12u);
}

TEST_F(PlanRows, InASearchAnotherOrderOrPrefixIsAnotherCase) {
    const auto last = [](const Plan& plan) { return plan.cases[plan.jobs[0].cases.back()].identity; };
    const std::string identity = last(matrix_plan("", "'ball'", "'half', 'cloud'"));
    EXPECT_EQ(identity,
              last(matrix_plan("", "'ball'", "'half', 'ball', 'cloud'")));  // the source is no target of its own
    EXPECT_EQ(identity, last(matrix_plan("", "'half', 'ball'", "'half', 'cloud'")));  // nor do other sources matter
    const std::set<std::string> targets = {identity, last(matrix_plan("", "'ball'", "'cloud', 'half'")),
                                           last(matrix_plan("", "'ball'", "'cloud'")),
                                           last(matrix_plan("", "'ball'", "'half'"))};
    EXPECT_EQ(targets.size(), 4u);
}

TEST_F(PlanRows, InASearchNothingIsReadOffAFinerRow) {
    EXPECT_EQ(matrix_plan("trace = true", "'ball', 'half'", "", "", "").traced.size(), 4u);
    EXPECT_TRUE(matrix_plan("trace = true", "'ball', 'half'", "").traced.empty());
    EXPECT_TRUE(
        matrix_plan("", "'ball', 'half'", "", "[[solver]]\nname = 'idle_exact'\nscenes = ['m']").traced.empty());
}

TEST_F(PlanRows, EachSolverHasASearchOfItsOwn) {
    const Plan two = matrix_plan("", "'ball'", "'half', 'cloud'", "[[solver]]\nname = 'idle_exact'\nscenes = ['m']");
    ASSERT_EQ(two.jobs.size(), 4u);
    for (const Job& job : two.jobs) {
        EXPECT_EQ(two.cases[job.cases[0]].chain, "");
        EXPECT_EQ(two.cases[job.cases[1]].chain, two.cases[job.cases[0]].identity);
    }
}

TEST_F(PlanRows, PairsThatAreNotRunAreNoPartOfASearch) {
    const Plan some = matrix_plan("", "'ball'", "'cloud', 'half'",
                                  "[[solver]]\nname = 'idle_without_points'\nquantity = 'symmetric'\nscenes = ['m']");
    std::size_t skipped = 0;
    for (std::size_t i = 0; i < some.cases.size(); ++i) {
        const Case& spec = some.cases[i];
        if (spec.solver != "idle_without_points") continue;
        EXPECT_EQ(spec.chain, "");
        skipped += some.decided.contains(i);
    }
    EXPECT_EQ(skipped, 2u);
}

TEST(Search, TheCutoffIsTheLeastUpperBoundButStaysAboveTheFloor) {
    const auto narrowed = [](double floor, double cutoff, double least) {
        WorkOrder::Item item{};
        item.query.floor = floor, item.query.cutoff = cutoff;
        item.narrow(least);
        return item.query.cutoff;
    };
    constexpr double none = std::numeric_limits<double>::infinity();
    EXPECT_EQ(narrowed(0, none, 3), 3);
    EXPECT_EQ(narrowed(0, 2, 3), 2);
    EXPECT_EQ(narrowed(0, none, none), none);
    EXPECT_EQ(narrowed(0, 2, std::nan("")), 2);
    EXPECT_EQ(narrowed(1, none, 1), std::nextafter(1.0, 2.0));
    EXPECT_EQ(narrowed(1, none, 0.5), std::nextafter(1.0, 2.0));
    EXPECT_EQ(narrowed(1, 1, 0.5), 1);  // the experiment itself sets cutoff = floor
    EXPECT_GT(narrowed(0, none, 0), 0);
    EXPECT_LT(narrowed(0, none, 0), 1e-150);
    EXPECT_EQ(narrowed(0, 1e-200, 0), 1e-200);
}

}  // namespace
}  // namespace hausbench
