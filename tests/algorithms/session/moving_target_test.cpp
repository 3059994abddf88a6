// Session undoes a rigid motion of the target by moving the source backwards. Bounds must hold for both shapes as
// posed() computes them. The test solver is so precise that each term of the cost of undoing is needed.
#include "algorithms/session/moving_target.h"
#include "algorithms/session/session.h"

#include "tests/support/random.h"
#include "tests/support/scenes.h"
#include "tests/support/truth.h"

#include <cmath>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

// Records the test solver's last query and what it built. `gap` widens its interval, as a fraction of the tolerance.
struct Seen {
    Query query;
    int built = 0;
    double gap = 0;
} seen;

struct CountedTree {
    static constexpr std::string_view structure_name = "counted tree";
    static constexpr int structure_layout = 1;
    explicit CountedTree(const TriangleMesh&) { ++seen.built; }
    std::size_t bytes() const { return 8; }
};

// Computes the distance of two meshes that are one point each.
class Sharp final : public Solver {
public:
    Needs needs(const Scene&, const QuerySet&) const override { return {need<CountedTree>(Side::target)}; }
    void prepare(const Scene& scene, const Prepared& prepared) override {
        (void)prepared.get<CountedTree>(Side::target);
        source_ = points_of(scene.source);
        target_ = points_of(scene.target);
    }
    Result solve(const Query& query, State*, Trace& trace) const override {
        seen.query = query;
        const Vec3 a = posed(source_, query.source_pose).row(0), b = target_.row(0);
        const Eigen::Matrix<long double, 3, 1> way = a.cast<long double>() - b.cast<long double>();
        const auto distance = static_cast<double>(std::sqrt(way.squaredNorm()));
        Result result;
        result.status = Status::converged;
        result.bounds = {std::max(0.0, next_down(distance)), next_up(distance) + seen.gap * query.tolerance.value};
        result.witness = {a, b, 0, 0, {}};
        trace.record(result.bounds.lower, result.bounds.upper);
        if (query.wanted.fields)
            result.fields = Fields{{"low", Field::Of::elements, Field::Meaning::lower, {result.bounds.lower}},
                                   {"high", Field::Of::elements, Field::Meaning::upper, {result.bounds.upper}},
                                   {"count", Field::Of::elements, Field::Meaning::number, {7}}};
        return result;
    }

private:
    Points source_, target_;
};

SolverEntry sharp() {
    SolverEntry entry;
    entry.info.name = "sharp";
    entry.info.source.mesh = entry.info.target.mesh = true;
    entry.info.certified = true;
    entry.info.abilities.insert({Ability::traces, Ability::fields, Ability::certificates});
    entry.info.abilities.insert(Ability::undone_motion);
    entry.info.may_need = {need<CountedTree>(Side::target)};
    entry.make = [](const Options&) -> std::unique_ptr<Solver> { return std::make_unique<Sharp>(); };
    return entry;
}

TriangleMesh point(const Vec3& at) { return soup(rows({at, at, at})); }

Query query_with(const Pose& source, const Pose& target, double tolerance = 1e-6) {
    Query query;
    query.source_pose = source;
    query.target_pose = target;
    query.tolerance = {Tolerance::Of::absolute, tolerance};
    return query;
}

struct Answer {
    Result result;
    TraceSample sample;
};

// Checks the bounds of the answer, of the trace and of fields against the exact distance of the posed points.
Answer check(const Vec3& a, const Vec3& b, const Pose& p, const Pose& g, const std::string& where) {
    const Session session(sharp(), Options("sharp", {}, {}), {point(a), point(b)},
                          {.moves = true, .finest_tolerance = 1e-6, .target_moves = true});
    Query query = query_with(p, g);
    query.wanted.fields = true;
    Trace trace(Trace::Mode::on);
    const Result result = session.solve(query, trace);
    EXPECT_TRUE(seen.query.target_pose.is_identity()) << where;
    EXPECT_EQ(result.status, Status::converged) << where;
    const exact::Rational squared =
        exact::squared_distance(exact::vector(posed(rows({a}), p).row(0)), exact::vector(posed(rows({b}), g).row(0)));
    const auto holds = [&](double lower, double upper, const char* what) {
        const exact::Rational low = lower, high = upper;
        EXPECT_TRUE(low * low <= squared) << where << ", " << what << ": lower " << lower;
        EXPECT_TRUE(high * high >= squared) << where << ", " << what << ": upper " << upper;
    };
    holds(result.bounds.lower, result.bounds.upper, "bounds");
    EXPECT_EQ(trace.samples().size(), 2U) << where;  // the solver's sample and the end
    holds(trace.samples()[0].lower, trace.samples()[0].upper, "trace");
    if (!result.fields || result.fields->size() != 3) {
        ADD_FAILURE() << where << ": no fields";
        return {result, trace.samples()[0]};
    }
    holds((*result.fields)[0].values[0], (*result.fields)[1].values[0], "fields");
    EXPECT_EQ((*result.fields)[2].values[0], 7);
    // The witness must prove the lower bound for the moved points.
    const double off = (result.witness.source_point - Vec3(posed(rows({a}), p).row(0))).norm();
    const double far = (result.witness.source_point - Vec3(posed(rows({b}), g).row(0))).norm();
    EXPECT_LE(result.bounds.lower, std::max(far - off, 0.0)) << where;
    return {result, trace.samples()[0]};
}

// Returns a turn about z with cosine 0.6 and sine 0.8, stretched by the factor 1 + `longer`.
Pose turned_and_longer(double longer, const Vec3& translation = Vec3::Zero()) {
    Pose pose;
    pose.rotation << 0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1;
    pose.rotation *= 1 + longer;
    pose.translation = translation;
    return pose;
}

constexpr double nearly = 0x1p-42;  // a stretch just within what counts as rigid

TEST(SessionUndo, AMotionThatStretchesALittle) {
    for (const double longer : {nearly, -nearly})
        check({0, 0, 0}, {0.75, 0.5, 0.25}, {}, turned_and_longer(longer), "stretched");
}

TEST(SessionUndo, APoseThatIsNotTheInverse) {
    const Pose g = turned_and_longer(nearly);
    const Vec3 a(0.75, 0.5, 0.25);
    check(a, g.rotation.transpose() * a, {}, g, "turned");  // the solver finds 0
}

TEST(SessionUndo, ATranslationThatIsNotTheInverse) {
    const Pose g = turned_and_longer(nearly);
    Pose p;
    p.translation = {0.75, -0.5, 0.25};
    check({0, 0, 0}, g.rotation.transpose() * p.translation, p, g, "moved");
}

TEST(SessionUndo, Rounding) {
    Random random(20);
    for (int i = 0; i < 2000; ++i) {
        Pose p, g;
        if (i % 2 == 1) p = turned_and_longer(0), g = turned_and_longer(0);
        p.translation = random.vector();
        g.translation = p.translation + random.vector(1e-3);
        const Vec3 a = random.vector(0.9);
        const Vec3 b = a + 1e-12 * random.vector() + (p.rotation.transpose() * (p.translation - g.translation));
        check(a, b, p, g, "pair " + std::to_string(i));
    }
}

TEST(SessionUndo, NothingIsBuiltAgain) {
    seen.built = 0;
    const Session session(sharp(), Options("sharp", {}, {}), {point({0, 0, 0}), point({0.75, 0, 0})},
                          {.moves = true, .finest_tolerance = 1e-6, .target_moves = true, .symmetric = true});
    EXPECT_EQ(seen.built, 2);  // one over B, and one over A for h(B,A)
    Trace trace;
    for (int i = 1; i < 4; ++i) {
        Query query = query_with(turned_and_longer(0, {0.1 * i, 0, 0}), turned_and_longer(0, {0, 0.1 * i, 0}));
        for (const Quantity quantity : {Quantity::directed, Quantity::symmetric}) {
            query.quantity = quantity;
            (void)session.solve(query, trace);
        }
    }
    EXPECT_EQ(seen.built, 2);
}

// The session copies the target if the motion cannot be undone, if undoing costs too much of the tolerance, or if a
// certificate would be about other shapes.
TEST(SessionUndo, ACopyWhereItMust) {
    const Session session(sharp(), Options("sharp", {}, {}), {point({0, 0, 0}), point({0.75, 0, 0})},
                          {.moves = true, .finest_tolerance = 1e-6, .target_moves = true});
    Trace trace;
    const auto built = [&](const Query& query) {
        seen.built = 0;
        (void)session.solve(query, trace);
        return seen.built;
    };
    const Query good = query_with({}, turned_and_longer(0, {0.5, 0, 0}));
    EXPECT_EQ(built(good), 0);
    Query query = good;
    query.target_pose = turned_and_longer(1e-6);
    EXPECT_EQ(built(query), 1) << "not rigid";
    query.target_pose.rotation << 1, 0x1p-30, 0, 0, 1, 0, 0, 0, 1;
    EXPECT_EQ(built(query), 1) << "a shear";
    query = good;
    query.tolerance.value = 1e-13;
    EXPECT_EQ(built(query), 1) << "a tolerance near the rounding";
    query.tolerance = {Tolerance::Of::lower, 1e-3};
    EXPECT_EQ(built(query), 1) << "a tolerance of the lower bound";
    query = good;
    query.floor = query.cutoff = 0.25;
    EXPECT_EQ(built(query), 1) << "is h above this?";
    query = good;
    query.wanted.certificate = true;
    EXPECT_EQ(built(query), 1) << "a proof";
    // Here undoing would give the solver shapes that are too small.
    const Session small(sharp(), Options("sharp", {}, {}), {point({0.75, 0, 0}), point({0, 0, 0})},
                        {.moves = true, .finest_tolerance = 1e-6, .target_moves = true});
    query = good;
    query.source_pose.rotation = 0x1p-600 * Eigen::Matrix3d::Identity();
    query.source_pose.translation = query.target_pose.translation;
    seen.built = 0;
    (void)small.solve(query, trace);
    EXPECT_EQ(seen.built, 1) << "tiny";
}

// copies_targets() must tell beforehand whether targets are copied.
TEST(SessionUndo, WhatIsCopiedIsSaidBeforehand) {
    const ShapeExtent a{ShapeKind::mesh, 0.5}, b{ShapeKind::mesh, 0.75};
    SolverInfo info = sharp().info;
    const auto copies = [&](const Query& query) { return copies_targets(info, query, a, b); };
    Query query = query_with({}, turned_and_longer(0, {0.5, 0, 0}));
    EXPECT_FALSE(copies(query));
    EXPECT_FALSE(copies(query_with(turned_and_longer(1e-6), {})));  // A may be stretched
    EXPECT_TRUE(copies(query_with({}, turned_and_longer(1e-6))));
    EXPECT_TRUE(copies(query_with({}, query.target_pose, 1e-13)));
    EXPECT_TRUE(copies_targets(info, query, {ShapeKind::points, 0.5}, b));
    EXPECT_TRUE(copies_targets(info, query, a, {ShapeKind::points, 0.75}));
    EXPECT_TRUE(copies_targets(info, query, a, {ShapeKind::mesh, 1e6}));  // rounding exceeds this tolerance
    query = query_with(turned_and_longer(1e-6), {});
    query.quantity = Quantity::symmetric;
    EXPECT_TRUE(copies(query));  // A is the target of h(B,A)
    info.abilities.insert(Ability::moving_target);
    EXPECT_FALSE(copies(query));
    info.abilities.clear();
    query.quantity = Quantity::directed;
    query.target_pose.translation = {1, 0, 0};
    EXPECT_TRUE(copies(query));
}

// A solver that handles a moving target itself must get the motion.
TEST(SessionUndo, ASolverThatTakesTheMotionGetsIt) {
    SolverEntry entry = sharp();
    entry.info.abilities.insert(Ability::moving_target);
    const Session session(entry, Options("sharp", {}, {}), {point({0, 0, 0}), point({0.75, 0, 0})},
                          {.moves = true, .finest_tolerance = 1e-6, .target_moves = true});
    Trace trace;
    (void)session.solve(query_with({}, turned_and_longer(0, {0.5, 0, 0})), trace);
    EXPECT_FALSE(seen.query.target_pose.is_identity());
}

// Even if the solver uses its whole tolerance, the answer must converge; floor and cutoff must leave room for the cost
// of undoing.
TEST(SessionUndo, PromisesLeaveRoom) {
    const Pose g = turned_and_longer(nearly, {0.5, 0, 0});
    const Session session(sharp(), Options("sharp", {}, {}), {point({0, 0, 0}), point({0.75, 0, 0})},
                          {.moves = true, .finest_tolerance = 1e-6, .target_moves = true});
    Trace trace;
    seen.gap = 1 - 1e-5;
    EXPECT_EQ(session.solve(query_with({}, g, 1e-9), trace).status, Status::converged);
    seen.gap = 0;
    Query query = query_with({}, g);
    query.floor = 0.9, query.cutoff = 2;
    (void)session.solve(query, trace);
    EXPECT_LT(seen.query.floor, 0.9 - 0x1p-44);
    EXPECT_GT(seen.query.floor, 0.9 - 1e-9);
    EXPECT_GT(seen.query.cutoff, 2 + 0x1p-44);
    EXPECT_LT(seen.query.cutoff, 2 + 1e-9);
    query.floor = 1e-14;
    (void)session.solve(query, trace);
    EXPECT_EQ(seen.query.floor, 0);
}

}  // namespace
}  // namespace hausbench
