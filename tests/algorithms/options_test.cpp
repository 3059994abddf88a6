#include "algorithms/options.h"
#include "algorithms/contract.h"
#include "algorithms/error.h"
#include "algorithms/registry.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

std::vector<ParameterSpec> specs() {
    return {
        {.name = "depth",
         .default_value = std::int64_t{6},
         .unit = "",
         .paper_value = "6",
         .description = "d",
         .choices = {},
         .least = 1,
         .most = 20},
        {.name = "ratio",
         .default_value = 0.5,
         .unit = "",
         .paper_value = "",
         .description = "r",
         .choices = {},
         .least = 0,
         .most = 1},
        {.name = "shuffle", .default_value = true, .unit = "", .paper_value = "", .description = "s", .choices = {}},
        {.name = "rule",
         .default_value = std::string("exact"),
         .unit = "",
         .paper_value = "",
         .description = "u",
         .choices = {"exact", "as_printed"}},
    };
}

std::string error_of(const ParameterMap& given) {
    try {
        Options("s", specs(), given);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(Options, DefaultsAndGivenValues) {
    const Options options("s", specs(), {{"depth", std::int64_t{3}}, {"rule", std::string("as_printed")}});
    EXPECT_EQ(options.integer("depth"), 3);
    EXPECT_EQ(options.real("ratio"), 0.5);
    EXPECT_TRUE(options.flag("shuffle"));
    EXPECT_EQ(options.text("rule"), "as_printed");
    EXPECT_TRUE(options.unread().empty());
}

TEST(Options, WholeNumberServesAsRealOne) {
    EXPECT_EQ(Options("s", specs(), {{"ratio", std::int64_t{1}}}).real("ratio"), 1.0);
}

TEST(Options, UnreadNamesWhatNobodyRead) {
    const Options options("s", specs(), {});
    (void)options.integer("depth");
    EXPECT_EQ(options.unread(), (std::vector<std::string>{"ratio", "rule", "shuffle"}));
}

TEST(Options, WrongInputIsNamed) {
    EXPECT_NE(error_of({{"dept", std::int64_t{3}}}).find("depth"), std::string::npos);
    EXPECT_NE(error_of({{"depth", 0.5}}).find("'depth'"), std::string::npos);
    EXPECT_NE(error_of({{"depth", std::int64_t{21}}}).find("21"), std::string::npos);
    EXPECT_NE(error_of({{"ratio", std::numeric_limits<double>::quiet_NaN()}}).find("'ratio'"), std::string::npos);
    EXPECT_NE(error_of({{"rule", std::string("wrong")}}).find("as_printed"), std::string::npos);
    EXPECT_NE(error_of({{"shuffle", std::int64_t{1}}}).find("'shuffle'"), std::string::npos);
    EXPECT_EQ(error_of({{"depth", std::int64_t{20}}, {"ratio", 0.0}}), "");
}

TEST(Options, ReadingWhatIsNotDeclaredIsABug) {
    const Options options("s", specs(), {});
    EXPECT_THROW((void)options.integer("missing"), std::logic_error);
    EXPECT_THROW((void)options.integer("ratio"), std::logic_error);
}

TEST(Registry, UnknownSolverNamesTheNearest) {
    try {
        (void)find_solver("naiv");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("naive"), std::string::npos);
    }
}

TEST(Registry, NamesAreUniqueAndParametersReadable) {
    std::set<std::string> names;
    for (const SolverEntry& entry : solvers()) {
        EXPECT_TRUE(names.insert(entry.info.name).second) << entry.info.name;
        EXPECT_FALSE(entry.info.title.empty());
        const auto& parameters = entry.info.parameters;
        if (std::any_of(parameters.begin(), parameters.end(), [](const auto& p) { return p.required(); })) {
            EXPECT_THROW(Options(entry.info.name, parameters, {}), InputError) << entry.info.name;
            continue;  // an outside program: it has no paper, and needs its command to be made
        }
        // Our own solvers come from no paper, and their titles say so.
        EXPECT_EQ(entry.info.paper.empty(), entry.info.title.ends_with("(ours)")) << entry.info.name;
        EXPECT_NO_THROW(check_contract(entry)) << entry.info.name;
    }
    for (const NotBuilt& missing : solvers_not_built()) EXPECT_FALSE(names.contains(missing.name));
}

TEST(Contract, NoDeclarationOfOursIsWrong) {
    for (const SolverEntry& entry : solvers()) EXPECT_EQ(declaration_error(entry.info), "") << entry.info.name;
}

TEST(Contract, WhatIsDeclaredWrongIsSaid) {
    const auto says = [](const char* what, auto change) {
        SolverInfo info;
        info.name = info.title = "wrong";
        info.source.points = info.target.mesh = true;
        info.parameters = {{"how", std::string("well"), "", "", "", {"well", "badly"}},
                           {"depth", std::int64_t(3), "", "", "", {}}};
        info.parameters[1].least = 1, info.parameters[1].most = 8;
        ASSERT_EQ(declaration_error(info), "");
        change(info);
        EXPECT_NE(declaration_error(info).find(what), std::string::npos) << what << ": " << declaration_error(info);
    };
    says("name is empty", [](SolverInfo& info) { info.name.clear(); });
    says("title is empty", [](SolverInfo& info) { info.title.clear(); });
    says("no shape as source", [](SolverInfo& info) { info.source = {}; });
    says("no shape as target", [](SolverInfo& info) { info.target = {}; });
    says("never certified", [](SolverInfo& info) { info.certified = true, info.known_wrong = "as printed"; });
    says("did you mean 'guthe2005'", [](SolverInfo& info) { info.paper = "guthe2006"; });
    says("without a name", [](SolverInfo& info) { info.parameters[1].name.clear(); });
    says("'how' twice", [](SolverInfo& info) { info.parameters[1].name = "how"; });
    says("'worse' is not one of its choices",
         [](SolverInfo& info) { info.parameters[0].default_value = std::string("worse"); });
    says("is not a text", [](SolverInfo& info) { info.parameters[1].choices = {"3"}; });
    says("is not a text", [](SolverInfo& info) { info.parameters[1].command = true; });
    says("outside [1, 2]", [](SolverInfo& info) { info.parameters[1].most = 2; });
    says("outside", [](SolverInfo& info) { info.parameters[1].default_value = std::nan(""); });
}

class Idle final : public Solver {
public:
    void prepare(const Scene&, const Prepared&) override {}
    Result solve(const Query&, State*, Trace&) const override { return {}; }
};

TEST(Contract, AConstructorReadsWhatIsDeclaredAndNothingElse) {
    SolverEntry entry;
    entry.info.name = "idle";
    entry.info.parameters = {{"how", std::string("well"), "", "", "", {}}};
    const auto make = [&] { return make_solver(entry, Options("idle", entry.info.parameters, {})); };
    entry.make = [](const Options& options) -> std::unique_ptr<Solver> {
        (void)options.text("how");
        return std::make_unique<Idle>();
    };
    EXPECT_NE(make(), nullptr);
    entry.make = [](const Options&) -> std::unique_ptr<Solver> { return std::make_unique<Idle>(); };
    EXPECT_THROW(make(), std::logic_error);
    entry.make = [](const Options& options) -> std::unique_ptr<Solver> {
        (void)options.text("how");
        return nullptr;
    };
    EXPECT_THROW(make(), std::logic_error);
}

}  // namespace
}  // namespace hausbench
