// How a session answers H(A,B), or queries with a moving target, using a solver that computes only h(A,B). A scripted
// solver records its queries.
#include "algorithms/session/moving_target.h"
#include "algorithms/session/session.h"

#include "algorithms/error.h"
#include "tests/support/scenes.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

// The test solver's answers to h(A,B) and h(B,A), and the queries it received. A has one point and B two, which tells
// the directions apart.
struct Script {
    Result says[2];
    std::vector<Query> queries;
    std::vector<QuerySet> prepared_for;
    std::chrono::milliseconds preparing{0}, solving{0};
    int built[2] = {0, 0};  // structures built over A and over B
    bool needs_both = true, exact = false;
} script;

std::size_t direction(const Shape& source) { return points_of(source).rows() == 1 ? 0 : 1; }

struct CountedStructure {
    static constexpr std::string_view structure_name = "counted structure";
    static constexpr int structure_layout = 1;
    explicit CountedStructure(const Points& points) : rows(points.rows()) { ++script.built[rows == 1 ? 0 : 1]; }
    std::size_t bytes() const { return 8; }
    Eigen::Index rows;
};

class Scripted final : public Solver {
public:
    explicit Scripted(const Options&) {}
    Needs needs(const Scene&, const QuerySet& queries) const override {
        script.prepared_for.push_back(queries);
        if (!script.needs_both) return {};
        return {need<CountedStructure>(Side::source), need<CountedStructure>(Side::target)};
    }
    void prepare(const Scene& scene, const Prepared&) override {
        std::this_thread::sleep_for(script.preparing);
        direction_ = direction(scene.source);
    }
    Result solve(const Query& query, State*, Trace& trace) const override {
        std::this_thread::sleep_for(script.solving);
        script.queries.push_back(query);
        const Result& result = script.says[direction_];
        trace.record(result.bounds.lower, result.bounds.upper);
        return result;
    }

private:
    std::size_t direction_ = 0;
};

SolverEntry scripted() {
    SolverEntry entry;
    entry.info.name = "scripted";
    entry.info.source.points = entry.info.target.points = true;
    entry.info.abilities.insert({Ability::traces, Ability::fields, Ability::certificates});
    entry.info.ignores_tolerance = script.exact;
    entry.info.may_need = {need<CountedStructure>(Side::source), need<CountedStructure>(Side::target)};
    entry.make = [](const Options& options) -> std::unique_ptr<Solver> { return std::make_unique<Scripted>(options); };
    return entry;
}

Result result_of(Status status, const Bounds& bounds, const std::string& note = {}) {
    Result result;
    result.status = status;
    result.bounds = bounds;
    result.note = note;
    return result;
}

// The largest coordinate is 0.5, so nothing is scaled.
const Scene scene{PointSet{rows({{0.5, 0, 0}})}, PointSet{rows({{0, 0, 0}, {0, 0.25, 0}})}};

Query symmetric_query() {
    Query query;
    query.quantity = Quantity::symmetric;
    query.tolerance = {Tolerance::Of::absolute, 0.01};
    return query;
}

Pose moved_by(const Vec3& translation) {
    Pose pose;
    pose.translation = translation;
    return pose;
}

class SessionDirections : public ::testing::Test {
protected:
    void SetUp() override { script = {}; }

    Session session(const QuerySet& queries = {.symmetric = true}) const {
        const SolverEntry entry = scripted();
        return Session(entry, Options(entry.info.name, {}, {}), scene, queries);
    }

    Result solve(const Query& query, const QuerySet& queries = {.symmetric = true}) {
        return session(queries).solve(query, trace);
    }

    Result solve(const Result& first, const Result& second, const Query& query = symmetric_query()) {
        script.says[0] = first;
        script.says[1] = second;
        return solve(query);
    }

    std::string status(const Result& first, const Result& second, const Query& query = symmetric_query()) {
        return std::string(to_string(solve(first, second, query).status));
    }

    Trace trace{Trace::Mode::on};
};

const Result small = result_of(Status::converged, {0.2, 0.2}), large = result_of(Status::converged, {0.4, 0.405});

// --- the second direction's question ----------------------------------------------------------------------------------

TEST_F(SessionDirections, TheFirstLowerBoundIsTheFloorOfTheSecond) {
    solve(result_of(Status::converged, {0.2, 0.205}), small);
    ASSERT_EQ(script.queries.size(), 2u);
    EXPECT_EQ(script.queries[0].floor, 0);
    EXPECT_EQ(script.queries[1].floor, 0.2);  // not the upper bound, because h(B,A) could be between the two
    EXPECT_EQ(script.queries[0].quantity, Quantity::directed);
    EXPECT_EQ(script.queries[1].quantity, Quantity::directed);
}

TEST_F(SessionDirections, AFloorThatIsHigherStays) {
    Query query = symmetric_query();
    query.floor = 0.3;
    solve(small, small, query);
    EXPECT_EQ(script.queries[0].floor, 0.3);
    EXPECT_EQ(script.queries[1].floor, 0.3);
}

// A floor at or above the cutoff would make it a yes/no question, which no tolerance ends.
TEST_F(SessionDirections, AFloorThatIsTheCutoffAsksNoQuestion) {
    Query query = symmetric_query();
    query.cutoff = 0.2;
    EXPECT_EQ(status(small, result_of(Status::converged, {0.195, 0.205}), query), "converged");
    ASSERT_EQ(script.queries.size(), 2u);
    EXPECT_LT(script.queries[1].floor, query.cutoff);
    EXPECT_GT(script.queries[1].floor, 0.1999);
    script.queries.clear();
    query.floor = query.cutoff;
    solve(small, small, query);
    EXPECT_EQ(script.queries[1].floor, query.cutoff);
}

// In scaled units the floor would overflow, and even an infinite upper bound would not be above it.
TEST_F(SessionDirections, AFloorStaysFinite) {
    script.says[0] = small;
    const SolverEntry entry = scripted();
    const Session session(entry, Options(entry.info.name, {}, {}),
                          {PointSet{rows({{0x1p-700, 0, 0}})}, PointSet{rows({{0, 0, 0}, {0, 0, 0}})}}, {});
    Query query;
    query.tolerance = {Tolerance::Of::absolute, 1};
    query.floor = 0x1p700;
    (void)session.solve(query, trace);
    EXPECT_EQ(script.queries[0].floor, std::numeric_limits<double>::max());
}

TEST_F(SessionDirections, PosesChangePlaces) {
    script.says[0] = script.says[1] = small;
    Query query = symmetric_query();
    query.source_pose = moved_by({0.125, 0, 0});
    query.target_pose = moved_by({0, 0.25, 0});
    solve(query);
    ASSERT_EQ(script.queries.size(), 2u);
    EXPECT_EQ(script.queries[0].source_pose.translation, Vec3(0.125, 0, 0));
    EXPECT_EQ(script.queries[1].source_pose.translation, Vec3(0, 0.25, 0));
    for (const Query& solved : script.queries)
        EXPECT_TRUE(solved.target_pose.is_identity());  // the target is a posed copy
}

// These limits are safe, because a sleep takes at least as long as requested.
TEST_F(SessionDirections, TimeThatIsSpentIsNotThereForTheSecond) {
    script.says[0] = script.says[1] = small;
    script.solving = std::chrono::milliseconds(3);
    Query query = symmetric_query();
    query.time_limit = 100;
    solve(query);
    EXPECT_LE(script.queries[0].time_limit, 100);
    EXPECT_LE(script.queries[1].time_limit, script.queries[0].time_limit - 0.003);
    script.queries.clear();
    query.time_limit = 0.001;
    solve(query);
    EXPECT_EQ(script.queries[1].time_limit, 0);
}

TEST_F(SessionDirections, PreparingAPosedCopyIsTimeThatIsSpent) {
    script.says[0] = small;
    script.preparing = std::chrono::milliseconds(3);
    Query query;
    query.tolerance = {Tolerance::Of::absolute, 0.01};
    query.target_pose = moved_by({0, 0.25, 0});
    query.time_limit = 100;
    solve(query, {.target_moves = true});
    EXPECT_LE(script.queries[0].time_limit, 100 - 0.003);
    query.time_limit = 0.001;
    solve(query, {.target_moves = true});
    EXPECT_EQ(script.queries[1].time_limit, 0);
}

// A tolerance relative to a lower bound of 0 cannot be met, so short trials find the direction with the larger bound,
// which comes first.
TEST_F(SessionDirections, TheLargerDirectionComesFirstWhereTheToleranceIsRelative) {
    Query query = symmetric_query();
    query.tolerance = {Tolerance::Of::lower, 1e-3};
    Result poor = result_of(Status::budget, {0.1, 0.9}), rich = result_of(Status::budget, {0.3, 0.9});
    poor.counters.subdivisions = rich.counters.subdivisions = 1;
    poor.reported = rich.reported = {{"share", 1.0}};
    const auto floors = [&](const Result& first, const Result& second) {
        script.queries.clear();
        const Result result = solve(first, second, query);
        EXPECT_EQ(result.bounds.lower, std::max(first.bounds.lower, second.bounds.lower));
        EXPECT_EQ(result.counters.subdivisions, script.queries.size());  // trials count too
        EXPECT_EQ(result.reported, (Reported{{"share", 1.0}, {"share (B to A)", 1.0}}));
        EXPECT_EQ(script.queries.back().budget, query.budget);
        std::vector<std::pair<double, std::uint64_t>> tried;
        for (const Query& q : script.queries) tried.push_back({q.floor, q.budget});
        return tried;
    };
    const std::uint64_t all = query.budget;
    using Tried = std::vector<std::pair<double, std::uint64_t>>;
    EXPECT_EQ(floors(rich, poor), (Tried{{0, 64}, {0, 64}, {0, all}, {0.3, all}}));
    EXPECT_EQ(floors(poor, rich), (Tried{{0, 64}, {0, 64}, {0, all}, {0.3, all}}));
    EXPECT_TRUE(script.queries[2].source_pose.is_identity());
    // No trials for exact solvers or absolute tolerances.
    script.exact = true;
    EXPECT_EQ(floors(poor, rich), (Tried{{0, all}, {0.1, all}}));
    script.exact = false;
    query.tolerance = {Tolerance::Of::absolute, 1e-3};
    EXPECT_EQ(floors(poor, rich), (Tried{{0, all}, {0.1, all}}));
    query.tolerance = {Tolerance::Of::lower, 1e-3};
    // A trial that answers its direction is not repeated.
    Result done = result_of(Status::converged, {0.2, 0.2});
    done.counters.subdivisions = 1;
    done.reported = poor.reported;
    EXPECT_EQ(floors(done, poor), (Tried{{0, 64}, {0.2, all}}));
    EXPECT_EQ(floors(poor, done).size(), 4u);
    // While both lower bounds are 0, the trials get more work.
    poor.bounds.lower = 0;
    query.budget = 5000;
    EXPECT_EQ(floors(poor, poor), (Tried{{0, 64}, {0, 64}, {0, 1024}, {0, 1024}, {0, 5000}, {0, 5000}}));
    query.budget = 64;
    EXPECT_EQ(floors(poor, poor), (Tried{{0, 64}, {0, 64}}));
}

// --- the answer -------------------------------------------------------------------------------------------------------

TEST_F(SessionDirections, BoundsAreTheLargerOnes) {
    const Result result = solve(result_of(Status::budget, {0.1, 0.4}), result_of(Status::budget, {0.2, 0.3}));
    EXPECT_EQ(result.bounds.lower, 0.2);
    EXPECT_EQ(result.bounds.upper, 0.4);
    const Result other = solve(result_of(Status::budget, {0.2, 0.3}), result_of(Status::budget, {0.1, 0.4}));
    EXPECT_EQ(other.bounds.lower, 0.2);
    EXPECT_EQ(other.bounds.upper, 0.4);
}

TEST_F(SessionDirections, TheWitnessOfTheLargerLowerBoundIsNamedByItsDirection) {
    Result first = small, second = large;
    first.witness = {Vec3(1, 0, 0), Vec3(2, 0, 0), 0, 1};
    second.witness = {Vec3(3, 0, 0), Vec3(4, 0, 0), 1, 0};
    const Witness forward = solve(large, first).witness;
    EXPECT_EQ(forward.direction, Witness::Direction::source_to_target);
    script.says[0] = first;
    const Witness backward = solve(first, second).witness;
    EXPECT_EQ(backward.direction, Witness::Direction::target_to_source);
    EXPECT_EQ(backward.source_point, Vec3(4, 0, 0));
    EXPECT_EQ(backward.target_point, Vec3(3, 0, 0));
    EXPECT_EQ(backward.source_element, 0);
    EXPECT_EQ(backward.target_element, 1);
    second.bounds.lower = first.bounds.lower;  // no larger, so the first witness stays
    EXPECT_EQ(solve(first, second).witness.source_point, Vec3(1, 0, 0));
}

TEST_F(SessionDirections, AFirstLowerBoundAboveTheCutoffEndsIt) {
    Query query = symmetric_query();
    query.cutoff = 0.1;
    Result first = result_of(Status::converged, {0.2, 0.205}, "of no use any more");
    const Result result = solve(first, large, query);
    EXPECT_EQ(script.queries.size(), 1u);
    EXPECT_EQ(to_string(result.status), "above_cutoff");
    EXPECT_EQ(result.bounds.lower, 0.2);
    EXPECT_EQ(result.bounds.upper, infinity);  // h(B,A) may have any value
    EXPECT_EQ(result.note, "");
    script.queries.clear();
    query.cutoff = 0.2;
    solve(first, small, query);
    EXPECT_EQ(script.queries.size(), 2u);
}

TEST_F(SessionDirections, TheStatusIsThatOfTheDirectionThatKeepsTheBoundsApart) {
    const Result timeout = result_of(Status::time_limit, {0.1, 0.9}, "slow"),
                 budget = result_of(Status::budget, {0.1, 0.8}, "poor");
    EXPECT_EQ(status(timeout, budget), "time_limit");
    EXPECT_EQ(status(budget, timeout), "time_limit");
    EXPECT_EQ(solve(budget, timeout).note, "slow");
    EXPECT_EQ(solve(timeout, budget).note, "slow");
    EXPECT_EQ(status(timeout, small), "time_limit");
    EXPECT_EQ(status(small, timeout), "time_limit");
    EXPECT_EQ(status(small, large), "converged");
    // A direction's failure does not count if the other direction's bounds are above it.
    const Result far = result_of(Status::precision_floor, {0, 0.3}, "tiny");
    EXPECT_EQ(status(far, large), "converged");
    EXPECT_EQ(status(large, far), "converged");
    EXPECT_EQ(solve(far, large).note, "");
    EXPECT_EQ(solve(large, far).note, "");
    // Only both directions together show that the bounds are close enough.
    const Result late = result_of(Status::time_limit, {0.1, 0.405}, "slow");
    const Result near = result_of(Status::converged, {0.4, 0.402});
    EXPECT_EQ(status(late, near), "converged");
    EXPECT_EQ(solve(late, near).note, "");
    const Result unbounded = result_of(Status::stalled, {0, std::numeric_limits<double>::quiet_NaN()}, "hard");
    for (const auto& [first, second] : {std::pair(small, unbounded), std::pair(unbounded, small)}) {
        EXPECT_EQ(status(first, second), "stalled");
        EXPECT_TRUE(std::isnan(solve(first, second).bounds.upper));
    }
}

TEST_F(SessionDirections, WorkIsTheSum) {
    Result first = small, second = large;
    first.counters = {.point_distances = 3, .subdivisions = 1};
    second.counters = {.point_distances = 4, .queue_pushes = 2};
    first.reported = {{"chosen", std::string("nohd")}};
    second.reported = {{"chosen", std::string("ohd")}};
    first.reported_seconds = 1;
    second.reported_seconds = 2;
    first.outside_bytes = 10;
    second.outside_bytes = 30;
    const Result result = solve(first, second);
    EXPECT_EQ(result.counters, (Counters{.point_distances = 7, .subdivisions = 1, .queue_pushes = 2}));
    EXPECT_EQ(result.reported, (Reported{{"chosen", std::string("nohd")}, {"chosen (B to A)", std::string("ohd")}}));
    EXPECT_EQ(result.reported_seconds, 3);
    EXPECT_EQ(result.outside_bytes, 30);
    EXPECT_EQ(solve(second, first).outside_bytes, 30);
}

TEST_F(SessionDirections, ATraceHoldsForBoth) {
    solve(result_of(Status::budget, {0.2, 0.3}), result_of(Status::budget, {0.1, 0.4}));
    ASSERT_EQ(trace.samples().size(), 3u);
    EXPECT_EQ(trace.samples()[0].lower, 0.2);
    EXPECT_EQ(trace.samples()[0].upper, infinity);  // h(B,A) is not known yet
    EXPECT_EQ(trace.samples()[1].lower, 0.2);
    EXPECT_EQ(trace.samples()[1].upper, 0.4);
    EXPECT_LE(trace.samples()[0].seconds, trace.samples()[1].seconds);
    EXPECT_LE(trace.samples()[1].seconds, trace.samples()[2].seconds);
    solve(result_of(Status::budget, {0.1, 0.4}), result_of(Status::budget, {0.2, 0.3}));
    EXPECT_EQ(trace.samples()[1].lower, 0.2);
    EXPECT_EQ(trace.samples()[1].upper, 0.4);
}

// --- parts that belong only to h(A,B), or that were not requested ------------------------------------------------------

TEST_F(SessionDirections, FieldsAndCertificatesAreThereOnlyWhereTheyAreWanted) {
    Result first = small;
    first.fields = Fields{{"upper", Field::Of::elements, Field::Meaning::upper, {0.2}}};
    first.certificates = {{"text", {}, 0.2, "h <= 0.2"}};
    script.says[0] = script.says[1] = first;
    Query query = symmetric_query();
    query.quantity = Quantity::directed;
    const auto check = [&](bool fields, bool certificate) {
        const Result result = solve(query);
        EXPECT_EQ(result.fields.has_value(), fields);
        EXPECT_EQ(result.certificates.size(), certificate ? 1u : 0u);
    };
    check(false, false);
    query.wanted.fields = true;
    check(true, false);
    query.wanted.certificate = true;
    check(true, true);
    SolverEntry entry = scripted();
    entry.info.abilities.erase(Ability::fields);
    entry.info.abilities.erase(Ability::certificates);
    const Result result = Session(entry, Options(entry.info.name, {}, {}), scene, {}).solve(query, trace);
    EXPECT_FALSE(result.fields);
    EXPECT_TRUE(result.certificates.empty());
}

TEST_F(SessionDirections, CertificatesOfHAreOneForEachDirectionOrNone) {
    using Direction = Witness::Direction;
    Result first = small, second = small;
    first.certificates = {{"text", {}, 0.2, "of h(A,B)"}};
    second.certificates = {{"text", {}, 0.3, "of h(B,A)"}};
    Query query = symmetric_query();
    query.wanted.certificate = true;
    const auto certificates = [&] {
        script.says[0] = first, script.says[1] = second;
        return solve(query).certificates;
    };
    std::vector<Certificate> both = certificates();
    ASSERT_EQ(both.size(), 2u);
    EXPECT_EQ(both[0].direction, Direction::source_to_target);
    EXPECT_EQ(both[0].bytes, "of h(A,B)");
    EXPECT_EQ(both[0].proven, 0.2);
    EXPECT_EQ(both[1].direction, Direction::target_to_source);
    EXPECT_EQ(both[1].bytes, "of h(B,A)");
    EXPECT_EQ(both[1].proven, 0.3);
    std::swap(first.certificates, second.certificates);
    first.certificates.clear();
    EXPECT_TRUE(certificates().empty());
    std::swap(first.certificates, second.certificates);
    first.certificates = {{"text", {}, 0.2, ""}}, second.certificates.clear();
    EXPECT_TRUE(certificates().empty());
    second.certificates = first.certificates;
    query.cutoff = 0.01;  // the second direction is skipped, so H has no upper bound
    EXPECT_TRUE(certificates().empty());
}

TEST_F(SessionDirections, CertificatesAreScaledBackOutward) {
    Result says = small;
    says.certificates = {{"text", Witness::Direction::target_to_source, 0.25, ""}};
    script.says[0] = says;
    const SolverEntry entry = scripted();
    Query query;
    query.tolerance = {Tolerance::Of::absolute, 8};
    query.wanted.certificate = true;
    const auto certificate = [&](const Points& source) {
        const Session session(entry, Options(entry.info.name, {}, {}), {PointSet{source}, scene.target}, {});
        return session.solve(query, trace).certificates.at(0);
    };
    EXPECT_EQ(certificate(rows({{4, 0, 0}})).proven, 2);  // the scene is scaled by 2^-3
    EXPECT_GT(certificate(rows({{0x1p1000, 0x1p-100, 0}})).proven, 0x1p999);
    EXPECT_EQ(certificate(rows({{4, 0, 0}})).direction, Witness::Direction::source_to_target);
}

TEST_F(SessionDirections, FieldsAreScaledBackOutward) {
    Result says = small;
    const auto field = [](Field::Meaning meaning) { return Field{"f", Field::Of::elements, meaning, {0.25}}; };
    says.fields = Fields{field(Field::Meaning::lower), field(Field::Meaning::upper), field(Field::Meaning::number)};
    script.says[0] = says;
    const SolverEntry entry = scripted();
    Query query;
    query.tolerance = {Tolerance::Of::absolute, 8};
    query.wanted.fields = true;
    const auto values = [&](const Scene& scaled) {
        const Session session(entry, Options(entry.info.name, {}, {}), scaled, {});
        const Result result = session.solve(query, trace);
        return Vec3((*result.fields)[0].values[0], (*result.fields)[1].values[0], (*result.fields)[2].values[0]);
    };
    EXPECT_EQ(values({PointSet{rows({{4, 0, 0}})}, scene.target}), Vec3(2, 2, 0.25));  // the scene is scaled by 2^-3
    const Vec3 wider = values({PointSet{rows({{0x1p1000, 0x1p-100, 0}})}, scene.target});
    EXPECT_LT(wider[0], 0x1p999);
    EXPECT_GT(wider[1], 0x1p999);
    EXPECT_EQ(wider[2], 0.25);
}

// --- preparation ------------------------------------------------------------------------------------------------------

TEST_F(SessionDirections, EveryPoseOfATargetPaysForItsStructures) {
    script.says[0] = script.says[1] = small;
    const Session moving = session({.target_moves = true});
    EXPECT_EQ(script.built[0], 1);
    EXPECT_EQ(script.built[1], 0);
    EXPECT_THROW((void)moving.prepared(), std::logic_error);
    Query query = symmetric_query();
    query.quantity = Quantity::directed;
    for (int i = 0; i < 3; ++i) {
        query.target_pose = i < 2 ? Pose{} : moved_by({0, 0.25, 0});  // also at rest
        (void)moving.solve(query, trace);
        EXPECT_EQ(script.built[0], 1);
        EXPECT_EQ(script.built[1], i + 1);
    }
    EXPECT_TRUE(copies_targets(scripted().info, query, {ShapeKind::points, 1}, {ShapeKind::points, 1}));
}

TEST_F(SessionDirections, AStructureIsBuiltOnceForBothDirections) {
    const Session both = session();
    EXPECT_EQ(script.built[0], 1);
    EXPECT_EQ(script.built[1], 1);
    std::vector<std::string> names;
    for (const PreparationTime& time : both.preparation()) names.push_back(time.name + (time.shared ? ", shared" : ""));
    EXPECT_EQ(names, (std::vector<std::string>{"source counted structure", "target counted structure", "solver",
                                               "solver (B to A)"}));
    EXPECT_EQ(both.prepare_bytes(), 16u);  // each structure counted once
}

std::atomic<int> slowly_built{0};

struct SlowStructure {
    static constexpr std::string_view structure_name = "slow structure";
    static constexpr int structure_layout = 1;
    explicit SlowStructure(const Points&) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        ++slowly_built;
    }
    std::size_t bytes() const { return 0; }
};

TEST_F(SessionDirections, TwoThreadsBuildAStructureOnce) {
    PreparedShape shape(scene.target, 0);
    const void* built[2] = {};
    const auto build = [&](int i) { built[i] = shape.structure(structure_kind<SlowStructure>()).object.get(); };
    std::thread first(build, 0), second(build, 1);
    first.join();
    second.join();
    EXPECT_EQ(built[0], built[1]);
    EXPECT_EQ(slowly_built, 1);
}

TEST_F(SessionDirections, SharedShapesSayWhatWasThere) {
    const SolverEntry entry = scripted();
    const Options options(entry.info.name, {}, {});
    const auto shape = [](const Shape& s) { return std::make_shared<PreparedShape>(s, 0); };
    const auto a = shape(scene.source), b = shape(scene.target), c = shape(PointSet{rows({{0, 0, 0}, {0, 0, 0.5}})});
    const auto shared = [&](const auto& source, const auto& target) {
        const Session session(entry, options, PreparedPair{source, target}, {});
        EXPECT_EQ(session.preparation().size(), 3u);
        EXPECT_FALSE(session.preparation()[2].shared);
        EXPECT_GE(session.preparation()[0].seconds, 0);
        return std::pair(session.preparation()[0].shared, session.preparation()[1].shared);
    };
    EXPECT_EQ(shared(a, b), std::pair(false, false));
    EXPECT_EQ(shared(a, c), std::pair(true, false));
    EXPECT_EQ(shared(c, b), std::pair(true, true));
    EXPECT_EQ(script.built[0], 1);
    EXPECT_EQ(script.built[1], 2);
    const PreparedPair differently{a, std::make_shared<PreparedShape>(Shape(scene.target), 1)};
    EXPECT_THROW(Session(entry, options, differently, {}), std::logic_error);
}

TEST_F(SessionDirections, NothingIsLeftOutOfAMovingSceneEither) {
    script.needs_both = false;
    const SolverEntry entry = scripted();
    const auto built = [&](const QuerySet& queries, Prepare build) {
        script.built[0] = script.built[1] = 0;
        const Session session(entry, Options(entry.info.name, {}, {}), scene, queries, build);
        return std::pair(script.built[0], script.built[1]);
    };
    EXPECT_EQ(built({}, Prepare::needed_only), std::pair(0, 0));
    EXPECT_EQ(built({}, Prepare::everything), std::pair(1, 1));
    EXPECT_EQ(built({.target_moves = true}, Prepare::needed_only), std::pair(0, 0));
    EXPECT_EQ(built({.target_moves = true}, Prepare::everything), std::pair(1, 0));
}

TEST_F(SessionDirections, MovesChangePlaces) {
    script.says[0] = script.says[1] = small;
    const auto seen = [&](std::size_t i) {
        return std::pair(script.prepared_for[i].moves, script.prepared_for[i].target_moves);
    };
    const Session moving = session({.moves = true, .symmetric = true});
    ASSERT_EQ(script.prepared_for.size(), 2u);
    EXPECT_EQ(seen(0), std::pair(true, false));
    EXPECT_EQ(seen(1), std::pair(false, true));
    // For h(B,A), A is the target, a copy at rest, and B does not move.
    (void)moving.solve(symmetric_query(), trace);
    EXPECT_EQ(seen(2), std::pair(false, false));
    Query query = symmetric_query();
    query.target_pose = moved_by({0, 0.25, 0});
    (void)moving.solve(query, trace);
    EXPECT_EQ(seen(3), std::pair(true, false));
    EXPECT_EQ(seen(4), std::pair(true, false));
    query.quantity = Quantity::directed;
    (void)session({.target_moves = true}).solve(query, trace);
    EXPECT_EQ(seen(5), std::pair(false, true));
    EXPECT_EQ(seen(6), std::pair(false, false));
}

TEST_F(SessionDirections, TheOtherDirectionIsRefusedWhereTheSolverDoesNotTakeIt) {
    SolverEntry entry = scripted();
    entry.info.target = {.points = false, .mesh = true};
    entry.info.may_need = {};
    script.needs_both = false;
    const Options options(entry.info.name, {}, {});
    const Scene mixed{scene.source, cube(0.5)};
    EXPECT_THROW(Session(entry, options, mixed, {.symmetric = true}), InputError);
    const Session directed(entry, options, mixed, {});
    EXPECT_THROW((void)directed.solve(symmetric_query(), trace), InputError);
}

}  // namespace
}  // namespace hausbench
