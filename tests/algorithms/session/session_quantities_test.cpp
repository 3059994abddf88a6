// The features that a session adds to every solver without them: H(A,B), a moving target, shapes
// shared by several pairs, several threads at once. Tests each registered solver on scenes of
// ordinary size; symmetric_test.cpp tests the session alone, term by term.
#include "algorithms/session/moving_target.h"
#include "algorithms/session/session.h"

#include "algorithms/error.h"
#include "algorithms/registry.h"
#include "tests/support/quick_options.h"
#include "tests/support/scenes.h"
#include "tests/support/truth.h"

#include <array>
#include <map>
#include <set>
#include <thread>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

struct PosePair {
    Pose source, target;
};

// The first pair of poses leaves A at rest, the last one B.
const std::array<PosePair, 3> pose_pairs{{{{}, turned(0.6, 0.8, {0.25, 0, -0.5})},
                                          {turned(0.28, 0.96, {-0.125, 0.5, 0}), turned(0.6, 0.8, {0.25, 0, -0.5})},
                                          {turned(0.96, 0.28, {0.5, -0.25, 0.125}), {}}}};

// Precision of the reference: enough to notice a missing pose or direction. solver_contract_test.cpp is stricter.
constexpr Real coarse = 1e-3L;

struct Case {
    TestScene test;
    std::array<Truth, 3> directed, symmetric;  // one per pair of poses
};

// Selects the named scenes, which stay well within the range of doubles at every pose.
std::vector<Case> some_cases(const std::vector<TestScene>& scenes, const std::set<std::string>& names) {
    std::vector<Case> all;
    for (const TestScene& test : scenes) {
        if (!names.contains(test.name)) continue;
        const auto truths = [&](Truth (*of)(const Scene&, Real)) {
            const auto at = [&](std::size_t i) {
                return of(posed(test.scene, pose_pairs[i].source, pose_pairs[i].target), coarse);
            };
            return std::array<Truth, 3>{at(0), at(1), at(2)};
        };
        all.push_back({test, truths(truth_of), truths(symmetric_truth_of)});
    }
    EXPECT_EQ(all.size(), names.size());
    return all;
}

const std::vector<Case>& cases() {
    static const std::vector<Case> list = [] {
        std::vector<Case> all = some_cases(
            point_scenes(), {"random", "random, offset 1e8", "single points", "one and the same point", "identical",
                             "one ulp apart", "collinear", "duplicates", "ties", "parallel planes", "sizes 1 : 1e9"});
        for (Case& c : some_cases(mesh_scenes(), {"random soups", "bumpy sheets", "two triangles", "identical",
                                                  "nested cubes", "sheet and its refinement", "zero area: segments",
                                                  "a point as target", "duplicate faces", "sizes 1 : 1e9"})) {
            all.push_back(std::move(c));
        }
        return all;
    }();
    return list;
}

Options defaults(const SolverEntry& entry) { return quick_options(entry); }

// Calls f(entry, case, "solver on scene") for all cases that fit. Surfaces do not move; surfaces_test.cpp tests them.
template <class F> void for_each_fitting(F&& f) {
    int solvers_tried = 0;
    for (const SolverEntry& entry : solvers()) {
        if (entry.info.source.surface || entry.info.name == "external" || !entry.info.known_wrong.empty()) continue;
        if (!entry.info.offers(Quantity::directed)) continue;  // tests of their own
        int tried = 0;
        for (const Case& c : cases()) {
            if (!refusal(entry.info, kind_of(c.test.scene.source), kind_of(c.test.scene.target)).empty()) continue;
            ++tried;
            f(entry, c, entry.info.name + " on " + c.test.name);
        }
        EXPECT_GE(tried, 9) << entry.info.name;
        ++solvers_tried;
    }
    EXPECT_GE(solvers_tried, 8);
}

Query query_of(std::size_t i, const Truth& truth, Quantity quantity = Quantity::directed) {
    Query query;
    query.quantity = quantity;
    query.source_pose = pose_pairs[i].source;
    query.target_pose = pose_pairs[i].target;
    query.tolerance = {Tolerance::Of::absolute, 100 * truth.tolerance};
    return query;
}

// Returns whether double precision resolves a thousandth of the tolerance.
bool easy(const SolverInfo& info, const Truth& truth) {
    return reaches_the_tolerance(info) && truth.tolerance > 1e3 * unit_roundoff * truth.magnitude;
}

// Returns a distance near the exact one.
Real about(const Truth& truth) { return truth.points ? exact::root(truth.squared) : truth.low; }

void check(const SolverEntry& entry, const Truth& truth, const Query& query, const Result& result,
           const std::string& where) {
    check_bounds(entry.info, truth, result.bounds, where);
    check_witness(truth.posed, result, where);
    const Bounds& b = result.bounds;
    EXPECT_EQ(result.status == Status::above_cutoff, b.lower > query.cutoff) << where;
    if (result.status == Status::below_floor) {
        EXPECT_LE(b.upper, query.floor) << where;
    }
    if (result.status == Status::converged) {
        EXPECT_EQ(query.answer(b.lower, b.upper), Status::converged) << where;
    }
}

// Scales both shapes by the session's exponent for the scene, or not at all for solvers that take original coordinates.
PreparedPair scaled_alike(const SolverInfo& info, const Scene& scene, int exponent) {
    if (info.original_coordinates) exponent = 0;
    return {std::make_shared<PreparedShape>(Shape(scene.source), exponent),
            std::make_shared<PreparedShape>(Shape(scene.target), exponent)};
}

// --- both poses -------------------------------------------------------------------------------------------------------

TEST(SessionPoses, BothAreHonoured) {
    for_each_fitting([](const SolverEntry& entry, const Case& c, const std::string& where) {
        const Session plain(entry, defaults(entry), c.test.scene, {.moves = true});
        const Session moving(entry, defaults(entry), c.test.scene, {.moves = true, .target_moves = true});
        for (std::size_t i = 0; i < pose_pairs.size(); ++i) {
            const std::string at = where + ", poses " + std::to_string(i);
            const Truth& truth = c.directed[i];
            Query query = query_of(i, truth);
            Trace trace(Trace::Mode::on);
            const Result result = plain.solve(query, trace);
            check(entry, truth, query, result, at);
            EXPECT_EQ(trace.samples().empty(), !entry.info.can(Ability::traces)) << at;
            if (easy(entry.info, truth)) {
                EXPECT_EQ(to_string(result.status), "converged") << at;
            }

            const Result other = moving.solve(query, trace);
            expect_same_answer(result, other, at);
            EXPECT_EQ(result.counters, other.counters) << at;

            // The answer must have the same bits as for a target moved beforehand.
            const int exponent = scale_exponent(
                std::max(magnitude(points_of(c.test.scene.source)), magnitude(points_of(c.test.scene.target))));
            const Session still(entry, defaults(entry),
                                scaled_alike(entry.info, posed(c.test.scene, {}, query.target_pose), exponent),
                                {.moves = true});
            const ShapeExtent a{kind_of(c.test.scene.source), magnitude(points_of(c.test.scene.source))},
                b{kind_of(c.test.scene.target), magnitude(points_of(c.test.scene.target))};
            const bool undone = entry.info.can(Ability::undone_motion) && !query.target_pose.is_identity() &&
                                !copies_targets(entry.info, query, a, b);
            query.target_pose = {};
            const Result beforehand = still.solve(query, trace);
            if (undone) {
                // The motion was undone instead, so the bits may differ.
                EXPECT_LE(result.bounds.lower, beforehand.bounds.upper) << at;
                EXPECT_GE(result.bounds.upper, beforehand.bounds.lower) << at;
                EXPECT_EQ(to_string(result.status), to_string(beforehand.status)) << at;
                continue;
            }
            expect_same_answer(result, beforehand, at);
            EXPECT_EQ(result.counters, beforehand.counters) << at;
        }
    });
}

// --- H(A,B) -----------------------------------------------------------------------------------------------------------

// Swaps the shapes, so that either direction is the larger one.
Scene turned_round(const Scene& scene) { return {scene.target, scene.source}; }

Query turned_round(Query query) {
    std::swap(query.source_pose, query.target_pose);
    return query;
}

// Work for H (`whole`) and for both directions separately (`apart`), summed over a solver's scenes. On scenes this
// small, bounds of groups, which a floor encourages, may cost up to an eighth more than they save.
struct Work {
    Counters whole, apart;

    void add(const Counters& both, const Counters& forward, const Counters& backward) {
        for (const CounterField& field : counter_fields) {
            whole.*field.member += both.*field.member;
            apart.*field.member += forward.*field.member + backward.*field.member;
        }
    }
};

TEST(SessionSymmetric, EnclosesTheLargerDirection) {
    std::map<std::string, std::set<Witness::Direction>> seen;
    std::map<std::string, Work> work;
    for_each_fitting([&](const SolverEntry& entry, const Case& c, const std::string& where) {
        const QuerySet moves{.moves = true, .target_moves = true};
        QuerySet both = moves;
        both.symmetric = true;
        const Session session(entry, defaults(entry), c.test.scene, both);
        const Session lean(entry, defaults(entry), c.test.scene, moves);  // prepares h(B,A) for each answer
        const Session back(entry, defaults(entry), turned_round(c.test.scene), moves);
        for (std::size_t i = 0; i < pose_pairs.size(); ++i) {
            const std::string at = where + ", poses " + std::to_string(i);
            const Truth& truth = c.symmetric[i];
            Query query = query_of(i, truth, Quantity::symmetric);
            Trace trace(entry.info.can(Ability::traces) ? Trace::Mode::on : Trace::Mode::off);
            const Result result = session.solve(query, trace);
            check(entry, truth, query, result, at);
            EXPECT_EQ(result.status == Status::converged, result.bounds.gap() <= query.tolerance.value) << at;
            if (easy(entry.info, truth)) {
                EXPECT_EQ(to_string(result.status), "converged") << at;
            }
            seen[entry.info.name].insert(result.witness.direction);

            double last = 0;
            for (const TraceSample& sample : trace.samples()) {
                check_bounds(entry.info, truth, {sample.lower, sample.upper}, at + ", trace");
                EXPECT_GE(sample.seconds, last) << at;
                last = sample.seconds;
            }
            if (entry.info.can(Ability::traces)) {
                EXPECT_EQ(trace.samples().back().lower, result.bounds.lower) << at;
                EXPECT_EQ(trace.samples().back().upper, result.bounds.upper) << at;
            }
            Trace none;  // tracing may cost work
            const Result untraced = session.solve(query, none), other = lean.solve(query, none);
            expect_same_answer(result, untraced, at);
            expect_same_answer(result, other, at);
            EXPECT_EQ(untraced.counters, other.counters) << at;
            query.quantity = Quantity::directed;
            const Result forward = lean.solve(query, none), backward = back.solve(turned_round(query), none);
            work[entry.info.name].add(untraced.counters, forward.counters, backward.counters);
            EXPECT_EQ(result.bounds.lower, std::max(forward.bounds.lower, result.bounds.lower)) << at;
        }
    });
    for (const auto& [name, directions] : seen) EXPECT_EQ(directions.size(), 2u) << name;
    for (const auto& [name, sums] : work) {
        for (const CounterField& field : counter_fields)
            EXPECT_LE(8 * sums.whole.*field.member, 9 * sums.apart.*field.member) << name << ", " << field.name;
    }
}

TEST(SessionSymmetric, BoundsHoldWhenStoppedEarly) {
    for_each_fitting([](const SolverEntry& entry, const Case& c, const std::string& where) {
        const Session session(entry, defaults(entry), c.test.scene, {.symmetric = true});
        const Truth& truth = c.symmetric[1];
        const auto solve = [&](auto&& change, const std::string& what) {
            Query query = query_of(1, truth, Quantity::symmetric);
            change(query);
            Trace trace;
            const Result result = session.solve(query, trace);
            check(entry, truth, query, result, where + ", " + what);
            return std::string(to_string(result.status));
        };
        for (const std::uint64_t budget : {0, 1, 3})
            solve([&](Query& q) { q.budget = budget; }, "budget " + std::to_string(budget));
        solve([](Query& q) { q.time_limit = 0; }, "no time");
        const auto h = static_cast<double>(about(truth));
        if (!reaches_the_tolerance(entry.info) || h < 1e6 * unit_roundoff * truth.magnitude) return;
        for (const double factor : {0.25, 0.5, 2.0}) {
            const double d = factor * h;
            const std::string at = std::to_string(factor) + " H";
            EXPECT_EQ(solve([&](Query& q) { q.cutoff = d; }, "cutoff " + at), factor < 1 ? "above_cutoff" : "converged")
                << where << ", cutoff " << at;
            EXPECT_EQ(solve([&](Query& q) { q.floor = d; }, "floor " + at), factor < 1 ? "converged" : "below_floor")
                << where << ", floor " << at;
            EXPECT_EQ(solve([&](Query& q) { q.floor = q.cutoff = d; }, "above " + at + "?"),
                      factor < 1 ? "above_cutoff" : "below_floor")
                << where << ", above " << at << "?";
        }
    });
}

// A tolerance relative to a lower bound of 0 cannot be met. If A is part of B, h(A,B) is 0, so the tolerance must be
// relative to H.
TEST(SessionSymmetric, ARelativeToleranceIsOfH) {
    const TriangleMesh part = soup(rows({{0.3, 0.2, 0}, {1.7, 0.45, 0}, {0.65, 1.6, 0}}));
    const TriangleMesh whole = sheet(7, 0);
    for (const SolverEntry& entry : solvers()) {
        if (!reaches_the_tolerance(entry.info) || !entry.info.source.mesh || !entry.info.offers(Quantity::directed))
            continue;
        for (const Scene& scene : {Scene{part, whole}, Scene{whole, part}}) {
            const Session session(entry, defaults(entry), scene, {.symmetric = true});
            Query query;
            query.quantity = Quantity::symmetric;
            query.tolerance = {Tolerance::Of::lower, 1e-3};
            query.budget = 100000;  // so that a failing search ends
            Trace trace;
            const Result result = session.solve(query, trace);
            check(entry, symmetric_truth_of(scene, coarse), query, result, entry.info.name);
            EXPECT_EQ(to_string(result.status), "converged") << entry.info.name;
            EXPECT_LT(result.counters.subdivisions, 5000u) << entry.info.name;
        }
    }
}

// --- structures that several pairs share ------------------------------------------------------------------------------

Shape resized(Shape shape, int exponent) {
    for (double& x : points_of(shape).reshaped()) x = std::ldexp(x, exponent);
    return shape;
}

std::vector<Shape> shapes_for(const SolverInfo& info, int ratio) {
    Random random(5);
    if (info.source.points && info.target.points && !info.source.mesh)
        return {PointSet{cloud(random, 60)}, resized(PointSet{cloud(random, 45)}, ratio), PointSet{lattice(6, 0.25)}};
    return {sheet(6, 0, 0.3), resized(sheet(7, 0.1, 0.2), ratio), cube(0.75)};
}

// Compares each pair of a matrix, whose shapes are all scaled alike, with the pair solved alone.
void check_matrix(const SolverEntry& entry, int ratio, const std::string& where) {
    const std::vector<Shape> shapes = shapes_for(entry.info, ratio);
    int exponent = -1000;
    for (const Shape& shape : shapes) {
        if (entry.info.original_coordinates)
            exponent = 0;
        else
            exponent = std::max(exponent, -scale_exponent(magnitude(points_of(shape))));
    }
    std::vector<std::shared_ptr<PreparedShape>> prepared;
    for (const Shape& shape : shapes) prepared.push_back(std::make_shared<PreparedShape>(shape, -exponent));
    std::map<std::pair<std::size_t, std::string>, int> built;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        for (std::size_t j = 0; j < shapes.size(); ++j) {
            const std::string at = where + ", " + std::to_string(i) + " to " + std::to_string(j);
            const Session shared(entry, defaults(entry), PreparedPair{prepared[i], prepared[j]}, {.symmetric = true});
            const Session alone(entry, defaults(entry), {shapes[i], shapes[j]}, {.symmetric = true});
            for (const Quantity quantity : {Quantity::directed, Quantity::symmetric}) {
                Query query;
                query.quantity = quantity;
                query.tolerance = {Tolerance::Of::lower, 1e-3};
                query.budget = 2000;
                Trace trace;
                const Result from_shared = shared.solve(query, trace), from_alone = alone.solve(query, trace);
                expect_same_answer(from_shared, from_alone, at);
                EXPECT_EQ(from_shared.counters, from_alone.counters) << at;
            }
            for (const PreparationTime& time : shared.preparation()) {
                if (time.name.find("solver") == 0 || time.shared) continue;
                const bool backward = time.name.ends_with(" (B to A)"), source = time.name.starts_with("source ");
                const std::string name = time.name.substr(7, backward ? time.name.size() - 16 : std::string::npos);
                ++built[{backward == source ? j : i, name}];
            }
        }
    }
    for (const auto& [key, times] : built) EXPECT_EQ(times, 1) << where << ": " << key.second << " of " << key.first;
    for (const Need& need : entry.info.may_need) {
        if (need.structure.name.find("octree") == std::string::npos) continue;
        EXPECT_TRUE(built.contains({0, need.structure.name})) << where << ": " << need.structure.name;
    }
}

TEST(SessionMatrix, SharedShapesHaveTheBitsOfEachPairAlone) {
    for (const SolverEntry& entry : solvers()) {
        if (entry.info.source.surface || entry.info.name == "external") continue;
        if (!entry.info.offers(Quantity::directed)) continue;  // tests of their own
        for (const int ratio : {0, -40, -60, 20}) {
            check_matrix(entry, ratio, entry.info.name + ", ratio 2^" + std::to_string(ratio));
        }
    }
}

// A shape so small that a common scale would cost it bits gets its own scale in each pair.
TEST(SessionMatrix, ARatioOf300BinaryOrdersIsSoundInTheScaleOfThePair) {
    for (const SolverEntry& entry : solvers()) {
        if (!entry.info.certified || entry.info.source.surface || !entry.info.offers(Quantity::directed)) continue;
        const std::vector<Shape> shapes = shapes_for(entry.info, -300);
        for (const auto& [i, j] : {std::pair{0, 1}, std::pair{1, 0}, std::pair{1, 1}}) {
            const Scene scene{shapes[std::size_t(i)], shapes[std::size_t(j)]};
            const std::string where =
                entry.info.name + ", " + std::to_string(i) + " to " + std::to_string(j) + ", ratio 2^-300";
            const Session session(entry, defaults(entry), scene, {.symmetric = true});
            for (const Quantity quantity : {Quantity::directed, Quantity::symmetric}) {
                const Truth truth =
                    quantity == Quantity::directed ? truth_of(scene, coarse) : symmetric_truth_of(scene, coarse);
                Query query;
                query.quantity = quantity;
                query.tolerance = {Tolerance::Of::absolute, truth.tolerance};
                Trace trace;
                const Result result = session.solve(query, trace);
                check_bounds(entry.info, truth, result.bounds, where);
                if (reaches_the_tolerance(entry.info)) {
                    EXPECT_EQ(to_string(result.status), "converged") << where;
                }
            }
        }
    }
}

// --- chains of poses --------------------------------------------------------------------------------------------------

TEST(SessionChains, WarmAnswersAreAsGoodAsColdOnes) {
    for_each_fitting([](const SolverEntry& entry, const Case& c, const std::string& where) {
        const Session session(entry, defaults(entry), c.test.scene, {.moves = true, .count = 20, .symmetric = true});
        const std::unique_ptr<State> state = session.begin();
        EXPECT_EQ(state != nullptr, entry.info.can(Ability::warm)) << where;
        const std::set<std::string> chosen{"random", "parallel planes", "random soups", "two triangles",
                                           "nested cubes"};
        if (!state || !chosen.contains(c.test.name)) return;
        for (int i = 0; i < 20; ++i) {
            const std::string at = where + ", pose " + std::to_string(i);
            const double t = 0.05 * i;  // (1 - t^2, 2 t) / (1 + t^2): a turn with rational entries
            Query query;
            query.source_pose = turned((1 - t * t) / (1 + t * t), 2 * t / (1 + t * t), {0.1 * t, 0, 0.2});
            const Truth truth = truth_of(posed(c.test.scene, query.source_pose), coarse);
            query.tolerance = {Tolerance::Of::absolute, 100 * truth.tolerance};
            Trace trace;
            const Result warm = session.solve(query, state.get(), trace), cold = session.solve(query, trace);
            check(entry, truth, query, warm, at);
            EXPECT_EQ(to_string(warm.status), to_string(cold.status)) << at;
        }
    });
}

// --- several threads --------------------------------------------------------------------------------------------------

std::vector<Query> some_queries(const Case& c, const SolverInfo& info) {
    std::vector<Query> all;
    for (std::size_t i = 0; i < pose_pairs.size(); ++i) {
        for (const Quantity quantity : {Quantity::directed, Quantity::symmetric}) {
            Query query = query_of(i, quantity == Quantity::directed ? c.directed[i] : c.symmetric[i], quantity);
            all.push_back(query);
            query.tolerance.value *= 1000;
            if (!info.ignores_tolerance) all.push_back(query);
        }
    }
    return all;
}

void ask_from_two_threads(const SolverEntry& entry, const Case& c, const std::string& where) {
    const std::vector<Query> queries = some_queries(c, entry.info);
    std::vector<Result> alone, forward(queries.size()), backward(queries.size());
    const auto answer_of = [](const Session& session, const Query& query) {
        Trace trace;
        return session.solve(query, trace);
    };
    const Session quiet(entry, defaults(entry), c.test.scene, {.moves = true, .symmetric = true});
    for (const Query& query : queries) alone.push_back(answer_of(quiet, query));
    const Session session(entry, defaults(entry), c.test.scene, {.moves = true, .symmetric = true});
    std::thread first([&] {
        for (std::size_t i = 0; i < queries.size(); ++i) forward[i] = answer_of(session, queries[i]);
    });
    std::thread second([&] {
        for (std::size_t i = queries.size(); i-- > 0;) backward[i] = answer_of(session, queries[i]);
    });
    first.join();
    second.join();
    for (std::size_t i = 0; i < queries.size(); ++i) {
        for (const Result& result : {forward[i], backward[i]}) {
            expect_same_answer(alone[i], result, where);
            EXPECT_EQ(alone[i].counters, result.counters) << where;
        }
    }
}

TEST(SessionThreads, OneSessionAnswersTwoThreads) { for_each_fitting(ask_from_two_threads); }

TEST(SessionThreads, TwoThreadsBuildTheStructuresOfOneShape) {
    for (const SolverEntry& entry : solvers()) {
        if (!entry.info.certified || entry.info.source.surface || !entry.info.offers(Quantity::directed)) continue;
        const Case* chosen = nullptr;
        for (const Case& c : cases()) {
            const Scene& scene = c.test.scene;
            if (refusal(entry.info, kind_of(scene.source), kind_of(scene.target)).empty()) chosen = &c;
        }
        ASSERT_TRUE(chosen);
        // No symmetric query was announced, so the first answer builds the structures for h(B,A).
        const Session session(entry, defaults(entry), chosen->test.scene, {});
        std::array<Result, 2> results;
        const auto ask = [&](std::size_t k) {
            Trace trace;
            results[k] = session.solve(query_of(1, chosen->symmetric[1], Quantity::symmetric), trace);
        };
        std::thread first(ask, 0), second(ask, 1);
        first.join();
        second.join();
        expect_same_answer(results[0], results[1], entry.info.name);
    }
}

TEST(SessionThreads, SeveralWorkersGiveTheSameInterval) {
    for_each_fitting([](const SolverEntry& entry, const Case& c, const std::string& where) {
        if (!entry.info.can(Ability::threads)) return;
        const Session session(entry, defaults(entry), c.test.scene, {.moves = true});
        Query query = query_of(1, c.directed[1]);
        Trace trace;
        const Result single = session.solve(query, trace);
        query.threads = 2;
        const Result several = session.solve(query, trace);
        check(entry, c.directed[1], query, several, where);
        EXPECT_EQ(single.status, several.status) << where;
        EXPECT_EQ(single.bounds.lower, several.bounds.lower) << where;
        EXPECT_EQ(single.bounds.upper, several.bounds.upper) << where;
    });
}

}  // namespace
}  // namespace hausbench
