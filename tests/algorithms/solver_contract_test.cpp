// The promises of every registered solver, tested on every small scene whose shapes it takes.
//
// A certified solver's bounds enclose the exact answer, whatever the status. The bounds of a solver
// that is not certified (a peer) may miss it by 1e-10 of the largest coordinate, unless
// `exceptions` lists the scene with a reason. A solver that keeps a published error (`known_wrong`)
// promises everything but its bounds; point_solvers_test.cpp shows that it is wrong.
#include "algorithms/error.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/quick_options.h"
#include "tests/support/scenes.h"
#include "tests/support/truth.h"

#include <algorithm>
#include <iostream>
#include <map>
#include <set>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

struct Exception {
    std::string solver, scene, reason;
};

// An entry is stale, and the test fails, unless its solver is seen to break the promise.
const std::vector<Exception>& exceptions() {
    static const std::vector<Exception> list = [] {
        std::vector<Exception> all;
        for (const char* base : {"random soups", "bumpy sheets"}) {
            for (const char* scale : {", scale -160", ", scale -80", ", scale 78", ", scale 150"}) {
                all.push_back(
                    {"cgal", std::string(base) + scale, "products of four lengths under- or overflow in double"});
            }
        }
        return all;
    }();
    return list;
}

bool excepted(const SolverInfo& solver, const std::string& scene) {
    for (const Exception& e : exceptions()) {
        if (e.solver == solver.name && e.scene == scene) return true;
    }
    return !solver.known_wrong.empty();
}

struct Case {
    TestScene test;
    std::vector<Truth> truths;  // one per pose
};

const std::vector<Case>& cases() {
    static const std::vector<Case> list = [] {
        std::vector<Case> all;
        for (auto scenes : {point_scenes(), mesh_scenes()}) {
            for (TestScene& test : scenes) {
                std::vector<Truth> truths;
                for (const Pose& pose : test.poses) truths.push_back(truth_of(posed(test.scene, pose)));
                all.push_back({std::move(test), std::move(truths)});
            }
        }
        return all;
    }();
    return list;
}

Query query_of(const Pose& pose, const Truth& truth) {
    Query query;
    query.source_pose = pose;
    query.tolerance = {Tolerance::Of::absolute, truth.tolerance};
    return query;
}

Options defaults(const SolverEntry& entry) { return quick_options(entry); }

Session session_of(const SolverEntry& entry, const TestScene& test, Prepare build = Prepare::needed_only,
                   const ParameterMap& given = {}) {
    QuerySet queries;
    queries.moves = test.poses.size() > 1;
    queries.count = test.poses.size();
    return Session(entry, quick_options(entry, given), test.scene, queries, build);
}

// True for `external`, which needs the command of a program; tests/program/test_external.py tests it.
bool needs_to_be_told(const SolverEntry& entry) {
    return std::any_of(entry.info.parameters.begin(), entry.info.parameters.end(),
                       [](const auto& p) { return p.required(); });
}

// Calls f(entry, case, "solver on scene") for all cases that fit a solver, and prints the number of cases.
template <class F> void for_each_fitting(F&& f) {
    for (const SolverEntry& entry : solvers()) {
        if (needs_to_be_told(entry)) continue;
        if (entry.info.source.surface) continue;               // surfaces_test.cpp
        if (!entry.info.offers(Quantity::directed)) continue;  // tests of their own
        int tried = 0;
        for (const Case& c : cases()) {
            if (!refusal(entry.info, kind_of(c.test.scene.source), kind_of(c.test.scene.target)).empty()) continue;
            ++tried;
            f(entry, c, entry.info.name + " on " + c.test.name);
        }
        std::cout << "    " << entry.info.name << ": " << tried << " scenes\n";
        EXPECT_GE(tried, 12) << entry.info.name;
    }
}

bool points_case(const Case& c) { return kind_of(c.test.scene.source) == ShapeKind::points; }

TEST(SolverContract, ReferenceIsRight) {
    const auto find = [](const std::string& name, bool points) -> const Truth& {
        for (const Case& c : cases()) {
            if (c.test.name == name && points_case(c) == points) return c.truths[0];
        }
        throw std::logic_error(name);
    };
    EXPECT_NEAR(static_cast<double>(find("nested cubes", false).low), 1, 2e-7);
    EXPECT_NEAR(static_cast<double>(find("parallel planes", false).low), std::sqrt(0.125 * 0.125), 1e-6);
    EXPECT_LE(static_cast<double>(find("identical", false).high), 1e-6);
    EXPECT_NEAR(static_cast<double>(find("duplicate faces", false).high), std::sqrt(3) / 4, 1e-6);
    EXPECT_TRUE(find("parallel planes", true).squared == exact::Rational(0.125) * exact::Rational(0.125));
    EXPECT_TRUE(find("permuted", true).squared == 0);
}

TEST(SolverContract, BoundsHoldAndTheWitnessShowsThem) {
    std::set<std::pair<std::string, std::string>> broken;
    for_each_fitting([&](const SolverEntry& entry, const Case& c, const std::string& where) {
        const Session session = session_of(entry, c.test);
        for (std::size_t i = 0; i < c.truths.size(); ++i) {
            const Truth& truth = c.truths[i];
            const std::string at = where + ", pose " + std::to_string(i);
            Trace trace(entry.info.can(Ability::traces) ? Trace::Mode::on : Trace::Mode::off);
            const Query query = query_of(c.test.poses[i], truth);
            const Result result = session.solve(query, trace);
            if (excepted(entry.info, c.test.name)) {
                // Assertions inside the library, if compiled in, may stop the solver first.
                const bool noticed = result.status == Status::stalled && std::isinf(result.bounds.upper);
                if (noticed || !encloses(result.bounds, truth, 1e-10 * truth.magnitude)) {
                    broken.insert({entry.info.name, c.test.name});
                }
                continue;
            }
            check_bounds(entry.info, truth, result.bounds, at);
            check_witness(truth.posed, result, at);

            const bool close = result.bounds.gap() <= query.tolerance.gap(result.bounds.lower);
            EXPECT_EQ(result.status == Status::converged, close) << at;
            // A tolerance is easy if a thousandth of it is well above rounding, and the scene is
            // not near the ends of the range.
            const bool easy = truth.tolerance > 1e3 * unit_roundoff * truth.magnitude && truth.magnitude > 1e-300 &&
                              truth.magnitude < 1e300;
            if (reaches_the_tolerance(entry.info) && easy) {
                EXPECT_EQ(to_string(result.status), to_string(Status::converged)) << at;
            }

            Bounds last;
            for (const TraceSample& sample : trace.samples()) {
                check_bounds(entry.info, truth, {sample.lower, sample.upper}, at + ", trace");
                last = {sample.lower, sample.upper};
            }
            EXPECT_EQ(trace.samples().empty(), !entry.info.can(Ability::traces)) << at;
            if (entry.info.can(Ability::traces)) {
                EXPECT_EQ(last.lower, result.bounds.lower) << at;
            }
            if (entry.info.can(Ability::traces)) {
                EXPECT_EQ(last.upper, result.bounds.upper) << at;
            }
        }
    });
    for (const Exception& e : exceptions()) {
        const bool built =
            std::any_of(solvers().begin(), solvers().end(), [&](const auto& s) { return s.info.name == e.solver; });
        if (built) {
            EXPECT_TRUE(broken.contains({e.solver, e.scene})) << "stale exception: " << e.solver << " on " << e.scene;
        }
    }
}

TEST(SolverContract, BoundsHoldWhenStoppedEarly) {
    for_each_fitting([&](const SolverEntry& entry, const Case& c, const std::string& where) {
        if (excepted(entry.info, c.test.name)) return;
        const Session session = session_of(entry, c.test);
        const Truth& truth = c.truths[0];
        const auto solve = [&](auto&& change, const std::string& what) {
            Query query = query_of(c.test.poses[0], truth);
            change(query);
            Trace trace;
            const Result result = session.solve(query, trace);
            check_bounds(entry.info, truth, result.bounds, where + ", " + what);
            check_witness(truth.posed, result, where + ", " + what);
            if (result.status == Status::above_cutoff) {
                EXPECT_GT(result.bounds.lower, query.cutoff) << where << ", " << what;
            }
            if (result.status == Status::below_floor) {
                EXPECT_LE(result.bounds.upper, query.floor) << where << ", " << what;
            }
            return result;
        };
        for (const std::uint64_t budget : {0, 1, 3}) {
            solve([&](Query& q) { q.budget = budget; }, "budget " + std::to_string(budget));
        }
        solve([](Query& q) { q.time_limit = 0; }, "no time");
        const Real h = points_case(c) ? exact::root(truth.squared) : truth.low;
        if (!(h > 1e-300L && h < 1e300L)) return;
        for (const double factor : {0.25, 0.5, 2.0}) {
            const double d = factor * static_cast<double>(h);
            const bool hopeless = !reaches_the_tolerance(entry.info) || truth.magnitude * unit_roundoff * 1e3 > h;
            const std::string at = std::to_string(factor) + " h";
            const Result above = solve([&](Query& q) { q.cutoff = d; }, "cutoff " + at);
            const Result below = solve([&](Query& q) { q.floor = d; }, "floor " + at);
            const Result question = solve([&](Query& q) { q.floor = q.cutoff = d; }, "above " + at + "?");
            if (hopeless) continue;
            EXPECT_EQ(to_string(above.status), factor < 1 ? "above_cutoff" : "converged") << where << ", cutoff " << at;
            EXPECT_EQ(to_string(below.status), factor < 1 ? "converged" : "below_floor") << where << ", floor " << at;
            EXPECT_EQ(to_string(question.status), factor < 1 ? "above_cutoff" : "below_floor") << where << ", " << at;
        }
        if (!reaches_the_tolerance(entry.info) || h < 1e9 * unit_roundoff * truth.magnitude) return;
        const Result relative = solve([](Query& q) { q.tolerance = {Tolerance::Of::lower, 1e-3}; }, "relative");
        EXPECT_EQ(to_string(relative.status), to_string(Status::converged)) << where;
        EXPECT_LE(relative.bounds.gap(), 1e-3 * relative.bounds.lower) << where;
    });
}

// Many random pairs, at a tolerance near the precision floor, where a bound that is off by one rounding would show.
TEST(SolverContract, BoundsHoldOnRandomPairs) {
    Random random(21);
    for (int i = 0; i < 100; ++i) {
        const double size = std::pow(10.0, -random.below(4)), apart = std::pow(10.0, -random.below(12));
        const Index na = 1 + random.below(8), nb = 1 + random.below(45);
        const bool mesh = i % 3 != 0;
        Points b = cloud(random, mesh ? 3 * nb : nb, size);
        Points a = cloud(random, mesh ? 3 * na : na, size);
        // Replaces about half of A's vertices with slightly moved vertices of B.
        for (Index v = 0; v < a.rows(); ++v) {
            if (random.below(2) != 0)
                a.row(v) = Vec3(b.row(random.below(static_cast<Index>(b.rows())))) + random.vector(apart);
        }
        Scene scene{PointSet{a}, PointSet{b}};
        if (mesh) scene = {soup(a), soup(b)};
        Pose pose;
        if (random.below(2) != 0) pose = turned(0.6, 0.8, random.vector());
        Truth truth = truth_of(posed(scene, pose));
        truth.tolerance = 1e-5 * size;
        const Case c{{"random pair " + std::to_string(i), scene, {Pose{}, pose}}, {truth, truth}};
        for (const SolverEntry& entry : solvers()) {
            if (!entry.info.certified || !refusal(entry.info, kind_of(scene.source), kind_of(scene.target)).empty())
                continue;
            const std::string where = entry.info.name + " on " + c.test.name;
            const Session session = session_of(entry, c.test);
            Trace trace;
            const Result result = session.solve(query_of(pose, truth), trace);
            if (reaches_the_tolerance(entry.info)) {
                EXPECT_EQ(to_string(result.status), to_string(Status::converged)) << where;
            }
            check_bounds(entry.info, truth, result.bounds, where);
            check_witness(truth.posed, result, where);
        }
    }
}

TEST(SolverContract, SameBitsEveryTimeInAnyOrder) {
    for_each_fitting([&](const SolverEntry& entry, const Case& c, const std::string& where) {
        const Session first = session_of(entry, c.test), second = session_of(entry, c.test);
        const std::size_t n = c.truths.size();
        std::vector<Result> forward(n), backward(n);
        Trace trace;
        for (std::size_t i = 0; i < n; ++i) forward[i] = first.solve(query_of(c.test.poses[i], c.truths[i]), trace);
        for (std::size_t i = n; i-- > 0;) backward[i] = second.solve(query_of(c.test.poses[i], c.truths[i]), trace);
        for (std::size_t i = 0; i < n; ++i) {
            expect_same_answer(forward[i], backward[i], where);
            EXPECT_EQ(forward[i].counters, backward[i].counters) << where;
        }
    });
}

TEST(SolverContract, NeedsAreUsedAndLeavingOutChangesNothing) {
    std::map<std::string, std::set<std::string>> needed;
    const auto compare = [&](const SolverEntry& entry, const Case& c, const ParameterMap& given,
                             const std::string& where) {
        const Session lean = session_of(entry, c.test, Prepare::needed_only, given),
                      full = session_of(entry, c.test, Prepare::everything, given);
        Trace trace;
        for (std::size_t i = 0; i < c.truths.size(); ++i) {
            const Query query = query_of(c.test.poses[i], c.truths[i]);
            expect_same_answer(lean.solve(query, trace), full.solve(query, trace), where);
        }
        for (const Need& need : lean.needs()) {
            EXPECT_TRUE(lean.prepared().uses().contains(to_string(need)))
                << where << " declares a " << to_string(need) << " and never uses it";
            needed[entry.info.name].insert(to_string(need));
        }
        EXPECT_EQ(full.needs().size(), entry.info.may_need.size()) << where;
        EXPECT_GE(full.preparation().size(), full.needs().size() + 1) << where;  // the needs and "solver"
    };
    for_each_fitting([&](const SolverEntry& entry, const Case& c, const std::string& where) {
        for (const ParameterMap& given : variants_of(entry)) {
            const std::string variant = given.empty() ? "" : ", " + given.begin()->first;
            const bool certified = entry.info.certified && entry.make(quick_options(entry, given))->certified();
            if (certified || given.empty()) compare(entry, c, given, where + variant);
        }
    });
    for (const SolverEntry& entry : solvers()) {
        if (!entry.info.offers(Quantity::directed)) continue;
        for (const Need& need : entry.info.may_need) {
            EXPECT_TRUE(needed[entry.info.name].contains(to_string(need)))
                << entry.info.name << " never asks for its " << to_string(need);
        }
    }
}

// Solves without Session, which would scale every scene to the same size first.
Result solve_as_it_is(const SolverEntry& entry, const Scene& scene, const QuerySet& queries, const Query& query) {
    const std::unique_ptr<Solver> solver = entry.make(defaults(entry));
    const Prepared prepared(scene, solver->needs(scene, queries));
    solver->prepare(scene, prepared);
    Trace trace;
    return solver->solve(query, nullptr, trace);
}

// Solvers have no hidden lengths: if nothing over- or underflows, a scene 2^k times as large has
// an answer 2^k times as large, for the same work.
TEST(SolverContract, PowersOfTwoScaleTheAnswerBitwise) {
    std::map<std::string, int> tried;
    for_each_fitting([&](const SolverEntry& entry, const Case& c, const std::string& where) {
        if (entry.info.original_coordinates) return;
        for (const int k : {7, -60, 90}) {
            Scene scaled = c.test.scene;
            bool exact = true;
            for (SharedShape* shape : {&scaled.source, &scaled.target}) {
                Shape copy = *shape;
                for (double& x : points_of(copy).reshaped()) {
                    exact = exact && (x == 0 || (std::abs(x) > 1e-20 && std::abs(x) < 1e10));
                    x = std::ldexp(x, k);
                }
                *shape = std::move(copy);
            }
            if (!exact) continue;
            ++tried[entry.info.name];
            const QuerySet queries{.moves = c.test.poses.size() > 1, .count = c.test.poses.size()};
            for (std::size_t i = 0; i < c.truths.size(); ++i) {
                Query query = query_of(c.test.poses[i], c.truths[i]);
                Result expected = solve_as_it_is(entry, c.test.scene, queries, query);
                query.tolerance.value = std::ldexp(query.tolerance.value, k);
                for (double& t : query.source_pose.translation) t = std::ldexp(t, k);
                const Result result = solve_as_it_is(entry, scaled, queries, query);
                expected.bounds = {std::ldexp(expected.bounds.lower, k), std::ldexp(expected.bounds.upper, k)};
                for (double& x : expected.witness.source_point) x = std::ldexp(x, k);
                for (double& x : expected.witness.target_point) x = std::ldexp(x, k);
                expect_same_answer(expected, result, where + ", times 2^" + std::to_string(k));
                EXPECT_EQ(expected.counters, result.counters) << where << ", times 2^" << k;
            }
        }
    });
    for (const auto& [name, count] : tried) EXPECT_GE(count, 12) << name;
    EXPECT_GE(tried.size(), 8u);
}

TEST(SolverContract, ParametersDoNotChangeWhatHolds) {
    const std::vector<std::pair<std::string, ParameterMap>> variants = {
        {"earlybreak", {{"shuffle", false}}},
        {"earlybreak", {{"seed", std::int64_t{7}}}},
        {"earlybreak", {{"exclude_common", true}}},
        {"lss", {{"sort", false}}},
        {"kdtree", {{"samples", std::int64_t{0}}}},
        {"nohd", {{"early_break", false}}},
        {"nohd", {{"depth", std::int64_t{0}}}},
        {"nohd", {{"depth", std::int64_t{60}}}},
        {"nohd", {{"build", std::string("to_depth")}}},
        {"ohd", {{"culling", std::string("none")}}},
        {"ohd", {{"lambda", 0.5}}},
        {"ohd", {{"lambda", 0.0}}},
        {"adaptive", {{"theta", 1.0}}},
        {"adaptive", {{"theta", 0.0}}},
        {"scan", {{"cells_from", std::int64_t{0}}, {"tree_from", std::int64_t{0}}}},
        {"kdtree", {{"leaf_size", std::int64_t{1}}}},
        {"cgal", {{"match_faces", false}}}};
    for (const auto& variant : variants) {
        const std::string& name = variant.first;
        const ParameterMap& given = variant.second;
        for_each_fitting([&](const SolverEntry& entry, const Case& c, const std::string& where) {
            if (entry.info.name != name || excepted(entry.info, c.test.name)) return;
            const Session session = session_of(entry, c.test, Prepare::needed_only, given);
            Trace trace;
            const Result result = session.solve(query_of(c.test.poses[0], c.truths[0]), trace);
            check_bounds(entry.info, c.truths[0], result.bounds, where + ", " + given.begin()->first);
            check_witness(c.truths[0].posed, result, where + ", " + given.begin()->first);
        });
    }
}

TEST(Session, RefusesWhatCannotBeAnswered) {
    const SolverEntry& naive = find_solver("naive");
    const Case& c = cases().front();
    const Session session = session_of(naive, c.test);
    Trace trace;
    const auto refused = [&](auto&& change) {
        Query query = query_of(c.test.poses[0], c.truths[0]);
        change(query);
        EXPECT_THROW((void)session.solve(query, trace), InputError);
    };
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {0.0, -1.0, nan, infinity}) refused([&](Query& q) { q.tolerance.value = bad; });
    for (const double bad : {-1.0, nan}) refused([&](Query& q) { q.cutoff = bad; });
    for (const double bad : {-1.0, nan}) refused([&](Query& q) { q.time_limit = bad; });
    refused([&](Query& q) { q.source_pose.rotation(1, 1) = nan; });
    refused([&](Query& q) { q.source_pose.translation[2] = infinity; });

    const Scene mixed{c.test.scene.source, cube(1)};
    EXPECT_THROW(Session(naive, defaults(naive), mixed, {}), InputError);
    EXPECT_NE(refusal(naive.info, ShapeKind::mesh, ShapeKind::points).find("naive"), std::string::npos);
}

TEST(Session, FindsParametersThatNobodyReads) {
    SolverEntry careless = find_solver("naive");
    careless.info.parameters = {{.name = "depth",
                                 .default_value = std::int64_t{6},
                                 .unit = "",
                                 .paper_value = "",
                                 .description = "",
                                 .choices = {}}};
    EXPECT_THROW(Session(careless, defaults(careless), cases().front().test.scene, {}), std::logic_error);
}

TEST(Session, KeepsTheTimesOfWhatItPrepares) {
    for (const Case& c : cases()) {
        if (c.test.name != "bumpy sheets") continue;
        const Session session = session_of(find_solver("guthe"), c.test);
        ASSERT_EQ(session.preparation().size(), 2u);
        EXPECT_EQ(session.preparation()[0].name, "target octree");
        EXPECT_EQ(session.preparation()[1].name, "solver");
        EXPECT_GT(session.prepare_bytes(), 50u * 3 * sizeof(double));  // at least its vertices
        EXPECT_GT(session.prepare_seconds(), 0);
        return;
    }
    FAIL() << "the scene is gone";
}

}  // namespace
}  // namespace hausbench
