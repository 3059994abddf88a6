// A session's own tasks: a status that follows from the bounds, scaling, and bounds widened for the loss by scaling.
//
// Compares with the exact h of point sets, moved as geometry.h defines. Mesh solvers get each point as a triangle with
// equal corners.
#include "algorithms/error.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/reference.h"
#include "tests/support/scenes.h"

#include <functional>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

Shape shape_of(const Points& points, bool mesh) {
    if (!mesh) return PointSet{points};
    TriangleMesh flat{points, {}};
    flat.triangles.resize(points.rows(), 3);
    for (Index i = 0; i < points.rows(); ++i) flat.triangles.row(i).setConstant(i);
    return flat;
}

Options defaults(const SolverEntry& entry) { return {entry.info.name, entry.info.parameters, {}}; }

Result answer(const SolverEntry& entry, const Points& a, const Points& b, const Query& query) {
    const bool mesh = !entry.info.source.points;
    Session session(entry, defaults(entry), {shape_of(a, mesh), shape_of(b, mesh)}, {.moves = true});
    Trace trace;
    return session.solve(query, trace);
}

Query relative(const Pose& pose, double tolerance = 1e-9) {
    Query query;
    query.source_pose = pose;
    query.tolerance = {Tolerance::Of::lower, tolerance};
    return query;
}

// Takes one solver, because the slack of another solver's bounds could hide an error of the session.
void expect_enclosed(const SolverEntry& entry, const Points& a, const Points& b, const Pose& pose,
                     const std::string& where = "") {
    const exact::Rational squared = exact_squared_hausdorff(posed(a, pose), b);
    const Bounds bounds = answer(entry, a, b, relative(pose)).bounds;
    const exact::Rational low = bounds.lower;
    EXPECT_GE(bounds.lower, 0) << entry.info.name << where;
    EXPECT_TRUE(low * low <= squared) << entry.info.name << where << ": lower " << bounds.lower;
    if (std::isinf(bounds.upper)) return;
    const exact::Rational high = bounds.upper;
    EXPECT_TRUE(high * high >= squared) << entry.info.name << where << ": upper " << bounds.upper << " against "
                                        << exact::root(squared);
}

// Uses naive: for points with small coordinates it computes every distance exactly, and adds nothing to a distance of 0.
void expect_enclosed(const Points& a, const Points& b, const Pose& pose = {}) {
    expect_enclosed(find_solver("naive"), a, b, pose);
}

std::vector<SolverEntry> certified_solvers() {
    std::vector<SolverEntry> all;
    for (const SolverEntry& entry : solvers()) {
        if (entry.info.certified && !entry.info.source.surface && entry.info.offers(Quantity::directed))
            all.push_back(entry);
    }
    EXPECT_GE(all.size(), 7u);
    return all;
}

Pose moved_by(const Vec3& translation) {
    Pose pose;
    pose.translation = translation;
    return pose;
}

Pose stretched(const Eigen::Matrix3d& rotation, const Vec3& translation = Vec3::Zero()) {
    Pose pose;
    pose.rotation = rotation;
    pose.translation = translation;
    return pose;
}

// --- the status follows from the bounds -------------------------------------------------------------------------------

// The answer that the test solver will give, in scaled units.
Result said;
bool samples = false;

class Claims final : public Solver {
public:
    explicit Claims(const Options&) {}
    void prepare(const Scene&, const Prepared&) override {}
    Result solve(const Query&, State*, Trace& trace) const override {
        if (samples) trace.record(said.bounds.lower, said.bounds.upper);
        return said;
    }
};

SolverEntry claims() {
    SolverEntry entry;
    entry.info.name = "claims";
    entry.info.source.points = entry.info.target.points = true;
    entry.info.abilities.insert(Ability::traces);
    entry.make = [](const Options& options) -> std::unique_ptr<Solver> { return std::make_unique<Claims>(options); };
    return entry;
}

Result after(Status status, const Bounds& bounds, double floor = 0, double cutoff = infinity, double largest = 0.5) {
    said = {};
    said.status = status;
    said.bounds = bounds;
    Query query;
    query.tolerance = {Tolerance::Of::absolute,
                       std::max(1e-5 * 2 * largest, std::numeric_limits<double>::denorm_min())};
    query.floor = floor;
    query.cutoff = cutoff;
    return answer(claims(), rows({{largest, 0, 0}}), rows({{0, 0, 0}}), query);
}

TEST(SessionStatus, NothingIsPassedWhereNothingWasAsked) {
    const Result wide = after(Status::above_cutoff, {0, 4e9});
    EXPECT_EQ(to_string(wide.status), to_string(Status::stalled));
    EXPECT_NE(wide.note.find("not above the cutoff"), std::string::npos);
    EXPECT_EQ(wide.bounds.upper, 4e9);
    // The note gives lengths in the unit of the input, whatever the scale of the scene.
    EXPECT_EQ(after(Status::converged, {0, 0.25}, 0, infinity, 1024).note,
              "the solver reports converged, but its gap 512 is above the tolerance 0.02048");
    EXPECT_EQ(after(Status::below_floor, {0, 0.25}, 16, infinity, 1024).note,
              "the solver reports below_floor, but its upper bound 512 is above the floor 16");
    EXPECT_EQ(to_string(after(Status::below_floor, {0, infinity}).status), to_string(Status::stalled));
    EXPECT_EQ(to_string(after(Status::below_floor, {0, 0}).status), to_string(Status::converged));
    EXPECT_EQ(to_string(after(Status::above_cutoff, {1, 1}).status), to_string(Status::converged));
}

TEST(SessionStatus, FloorAndCutoffAreAnsweredWhereABoundPassesThem) {
    const auto status = [](const Bounds& bounds, double floor, double cutoff) {
        return std::string(to_string(after(Status::above_cutoff, bounds, floor, cutoff).status));
    };
    EXPECT_EQ(status({0, 2}, 2, infinity), "below_floor");
    EXPECT_EQ(status({0, 2}, 2, 2), "below_floor");
    EXPECT_EQ(status({0, 0}, 0, 0), "below_floor");
    EXPECT_EQ(status({2, 9}, 0, 1), "above_cutoff");
    EXPECT_EQ(status({2, 9}, 1, 1), "above_cutoff");
    EXPECT_EQ(status({2, infinity}, 1, 1), "above_cutoff");
    EXPECT_EQ(status({2, 9}, 0, 2), "stalled");
    EXPECT_EQ(status({1, 3}, 2, 2), "stalled");
    EXPECT_EQ(status({1.5, 1.5}, 1.5, 1.5), "below_floor");
    // If floor == cutoff, the query is a yes/no question, which a small gap does not answer.
    EXPECT_EQ(status({1.5, 1.5 + 1e-9}, 1.5, 1.5), "stalled");
    EXPECT_EQ(status({1.5, 1.5 + 1e-9}, 0, 1.5), "converged");
    // The part of the interval below the floor does not count as a gap.
    EXPECT_EQ(status({0, 1.5 + 1e-9}, 1.5, infinity), "converged");
    EXPECT_EQ(status({0, 1.6}, 1.5, infinity), "stalled");
}

TEST(SessionStatus, ConvergedIsAGapWithinTheTolerance) {
    const Result wide = after(Status::converged, {0, 4e9});
    EXPECT_EQ(to_string(wide.status), to_string(Status::stalled));
    EXPECT_NE(wide.note.find("gap"), std::string::npos);
    EXPECT_EQ(to_string(after(Status::converged, {1, 1 + 9e-6}).status), to_string(Status::converged));
    EXPECT_EQ(to_string(after(Status::budget, {0, 4e9}).status), to_string(Status::budget));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(to_string(after(Status::converged, {nan, nan}).status), to_string(Status::stalled));
    for (const Bounds& none : {Bounds{nan, 1e-9}, Bounds{0, nan}, Bounds{infinity, infinity}, Bounds{-1e-9, -1e-10}}) {
        const Result impossible = after(Status::converged, none);
        EXPECT_EQ(to_string(impossible.status), to_string(Status::stalled)) << none.lower << ", " << none.upper;
        EXPECT_NE(impossible.note.find("are not an interval of distances"), std::string::npos) << impossible.note;
        EXPECT_EQ(to_string(after(Status::above_cutoff, none, 0, 0.5).status), to_string(Status::stalled));
        EXPECT_EQ(to_string(after(Status::below_floor, none, 0.5, 0.5).status), to_string(Status::stalled));
    }
    // A loss by scaling back counts as the precision floor, not as the solver's failure.
    const double least = std::numeric_limits<double>::denorm_min();
    EXPECT_EQ(to_string(after(Status::converged, {0.3, 0.3}, 0, infinity, least).status), "precision_floor");
    EXPECT_EQ(to_string(after(Status::below_floor, {0.32, 0.6}, 5 * least, 5 * least, 8 * least).status),
              "precision_floor");
}

// In units of the least double: the reported point is rounded, by up to half a unit, which the lower bound must
// include.
TEST(SessionStatus, ALowerBoundHoldsWithThePointThatIsShown) {
    const double least = std::numeric_limits<double>::denorm_min();
    const auto lower = [&](double bound, double source, double target) {
        said = {};
        said.bounds = {bound, 0.5};
        said.witness.source_point = Vec3(source, 0, 0);
        said.witness.target_point = Vec3(target, 0, 0);
        Query query;
        query.tolerance = {Tolerance::Of::absolute, least};
        return answer(claims(), rows({{16 * least, 0, 0}}), rows({{0, 0, 0}}), query).bounds.lower / least;
    };
    EXPECT_EQ(lower(0.5, 0.5, 0), 16);
    EXPECT_EQ(lower(0.5, 0.5 + 0x1p-10, 0), 15);
    EXPECT_EQ(lower(0.5, 0.5, 0x1p-10), 16);
    EXPECT_EQ(lower(0, 0.5 + 0x1p-10, 0), 0);
}

// --- poses that leave the range ---------------------------------------------------------------------------------------

TEST(SessionRange, APoseWhoseShapeIsNotFiniteIsRefused) {
    const Points a = rows({{1e308, 0, 0}, {0, 0, 0}}), b = rows({{1, 0, 0}, {-1e308, 0, 0}});
    Eigen::Matrix3d twice = Eigen::Matrix3d::Identity() * 2;
    Eigen::Matrix3d cancels = Eigen::Matrix3d::Identity();
    cancels.row(0) << 2, -1.5, 0;  // the first product overflows, whatever is added
    for (const SolverEntry& entry : solvers()) {
        if (entry.info.source.surface || entry.info.name == "external" || !entry.info.offers(Quantity::directed))
            continue;
        const auto refused = [&](const Points& source, const Pose& pose) {
            EXPECT_THROW((void)answer(entry, source, b, relative(pose)), InputError) << entry.info.name;
        };
        refused(a, moved_by({1.7e308, 0, 0}));
        refused(a, stretched(twice));
        refused(rows({{1e308, 1e308, 0}}), stretched(cancels));
        if (!entry.info.certified) continue;
        EXPECT_NO_THROW((void)answer(entry, a, b, relative(moved_by({-1e308, 0, 0})))) << entry.info.name;
    }
    try {
        (void)answer(find_solver("naive"), a, b, relative(moved_by({1.7e308, 0, 0})));
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("pose"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("larger unit"), std::string::npos);
    }
}

TEST(SessionRange, FarPosesAreScaledByThePosedExtents) {
    Random random(5);
    const Points a = cloud(random, 6), b = cloud(random, 40);
    std::vector<Pose> poses;
    for (const double far : {1e100, 1e121, 1e160, 1e300}) {
        poses.push_back(moved_by({far, -0.5 * far, 0}));
        poses.push_back(stretched(far * turned(0.6, 0.8, Vec3::Zero()).rotation, {1, 0, 0}));
    }
    for (const SolverEntry& entry : certified_solvers()) {
        for (const Pose& pose : poses) {
            for (const double unit : {1.0, 0x1p-700}) {
                if (unit != 1 && pose.translation[0] > 1) continue;
                const Result result = answer(entry, unit * a, unit * b, relative(pose));
                EXPECT_EQ(to_string(result.status), "converged") << entry.info.name << pose.translation.transpose();
                expect_enclosed(entry, unit * a, unit * b, pose);
                const exact::RVec3 p = exact::vector(result.witness.source_point);
                const Points there = posed(unit * a, pose);
                bool attained = false;
                for (Index i = 0; i < there.rows(); ++i) attained = attained || exact::vector(there.row(i)) == p;
                EXPECT_TRUE(attained) << entry.info.name;
            }
        }
    }
}

TEST(SessionRange, FarPosesOfTheTargetAreScaledByThePosedExtents) {
    Random random(6);
    const Points a = cloud(random, 6), b = cloud(random, 40);
    for (const SolverEntry& entry : certified_solvers()) {
        for (const double far : {1e121, 1e300}) {
            Query query = relative(moved_by({1, 2, 3}));
            query.target_pose = moved_by({far, -0.5 * far, 0});
            const Bounds bounds = answer(entry, a, b, query).bounds;
            const exact::Rational low = bounds.lower, high = bounds.upper;
            const exact::Rational squared =
                exact_squared_hausdorff(posed(a, query.source_pose), posed(b, query.target_pose));
            EXPECT_TRUE(low * low <= squared && squared <= high * high) << entry.info.name << far;
        }
    }
    Query query = relative({});
    query.target_pose = moved_by({1.7e308, 0, 0});
    EXPECT_THROW((void)answer(find_solver("naive"), 1e308 * a, 1e308 * b, query), InputError);
}

// Poses shrink or enlarge both shapes, or only one. Squares of lengths leave the range of doubles
// below 2^-537 and above 2^512.
TEST(SessionRange, PosesOfEverySizeAreAnswered) {
    Random random(7);
    const Points a = cloud(random, 6), b = cloud(random, 20);
    const Eigen::Matrix3d turn = turned(0.6, 0.8, Vec3::Zero()).rotation;
    for (const SolverEntry& entry : certified_solvers()) {
        for (const int exponent : {-1000, -700, -537, -401, -399, 399, 401, 513, 900}) {
            const double size = std::ldexp(1.0, exponent);
            for (const bool source : {true, false}) {
                for (const bool target : {true, false}) {
                    Query query = relative({});
                    if (source) query.source_pose = stretched(size * turn, {0.25 * size, 0, size});
                    if (target) query.target_pose = stretched(size * turn.transpose(), {0, size, 0});
                    const Result result = answer(entry, a, b, query);
                    const exact::Rational low = result.bounds.lower, high = result.bounds.upper;
                    const exact::Rational squared =
                        exact_squared_hausdorff(posed(a, query.source_pose), posed(b, query.target_pose));
                    const std::string where = entry.info.name + ", 2^" + std::to_string(exponent) +
                                              (source ? " A" : "") + (target ? " B" : "");
                    EXPECT_TRUE(low * low <= squared && squared <= high * high) << where << ": " << result.bounds.upper;
                    EXPECT_EQ(to_string(result.status), "converged") << where << ", " << result.note;
                }
            }
        }
    }
}

// In scaled units, all coordinates become 0, but not in input units.
TEST(SessionRange, PosesThatShrinkBelowWhatScaledUnitsHold) {
    const Points a = rows({{0x1p500, 0, 0}}), b = rows({{0, 0x1p500, 0}});
    Query query = relative(stretched(0x1p-1074 * Eigen::Matrix3d::Identity(), {0x1p-640, 0, 0}));
    query.target_pose = stretched(0x1p-1074 * Eigen::Matrix3d::Identity());
    for (const SolverEntry& entry : certified_solvers()) {
        const Result result = answer(entry, a, b, query);
        EXPECT_EQ(to_string(result.status), "converged") << entry.info.name;
        EXPECT_NEAR(std::ldexp(result.bounds.lower, 574), std::sqrt(2), 1e-8) << entry.info.name;
    }
}

// A pose must apply to the input coordinates, not to the scaled ones, which have lost bits.
TEST(SessionRange, FarPosesKeepWhatScalingLoses) {
    const Points b = rows({{0x1p10, 0, 0}, {0, 0, 0}});  // scaled by 2^-11
    Eigen::Matrix3d huge = Eigen::Matrix3d::Identity();
    huge(0, 0) = 0x1p1020;
    const Result far =
        answer(find_solver("naive"), rows({{0x1p-1073, 0, 0}}), b, relative(stretched(huge, {0, 0x1p500, 0})));
    EXPECT_EQ(far.witness.source_point, Vec3(0x1p-53, 0x1p500, 0));
}

TEST(SessionRange, FarPosesAreTraced) {
    const Points a = rows({{0x1p10, 0, 0}}), b = rows({{0, 0, 0}});
    Trace trace(Trace::Mode::on);
    const SolverEntry& guthe = find_solver("guthe");
    const Session session(guthe, defaults(guthe), {shape_of(a, true), shape_of(b, true)}, {.moves = true});
    const Result traced = session.solve(relative(moved_by({0, 0x1p500, 0})), trace);
    ASSERT_FALSE(trace.samples().empty());
    EXPECT_EQ(trace.samples().back().lower, traced.bounds.lower);
    EXPECT_EQ(trace.samples().back().upper, traced.bounds.upper);
}

// --- what scaling loses, term by term ---------------------------------------------------------------------------------

TEST(SessionWidening, CoordinatesThatScalingRounds) {
    const double large = 0x1p1000, tiny = 0x1p-100;  // tiny becomes 0 when scaled by 2^-1001
    const Points plain = rows({{large, 0, 0}}), raised = rows({{large, tiny, 0}});
    expect_enclosed(plain, raised);
    expect_enclosed(raised, plain);
    Pose turned_over;
    turned_over.rotation = -turned_over.rotation;
    expect_enclosed(plain, -raised, turned_over);
    EXPECT_EQ(answer(find_solver("naive"), plain, plain, relative({})).bounds.upper, 0);  // nothing else is widened
}

// The scaling that brings 1e300 into range turns 1e-300 into 0.
TEST(SessionWidening, WitnessPointsOfPointSetsAreThoseOfTheInput) {
    const Points a = rows({{1e300, 1e-300, 0}}), b = rows({{-1e300, 0, 1e-300}});
    for (const Pose& pose : {Pose{}, moved_by({1e300, 0, 0})}) {
        const Result result = answer(find_solver("naive"), a, b, relative(pose));
        EXPECT_EQ(result.witness.source_point, Vec3(posed(a, pose).row(0)));
        EXPECT_EQ(result.witness.target_point, Vec3(b.row(0)));
    }
}

TEST(SessionWidening, APoseEnlargesWhatScalingRounds) {
    const Points b = rows({{0, 0, 0}, {0x1p1000, 0, 0}});
    expect_enclosed(rows({{0x1p-74, 0, 0}}), b, stretched(0x1p60 * Eigen::Matrix3d::Identity()));
    expect_enclosed(rows({{0x1p-74, 0x1p-74, -0x1p-74}}), b, stretched(0x1p60 * Eigen::Matrix3d::Ones()));
}

TEST(SessionWidening, ProductsThatUnderflow) {
    const double least = 0x1p-1074;
    const Points origin = rows({{0, 0, 0}});
    const Eigen::Matrix3d halves = 0.5 * Eigen::Matrix3d::Ones();
    // In units of the least double, each product is 0.5 or 1.5, a tie, and is rounded to 0 or 2.
    expect_enclosed(rows({{least, least, least}}), origin, stretched(halves));
    expect_enclosed(rows({{3 * least, 3 * least, 3 * least}}), origin, stretched(halves));
    expect_enclosed(rows({{3 * least, 3 * least, 3 * least}}), origin, stretched(-halves));
    // A nearly infinite entry that only multiplies zeros must do no harm.
    Eigen::Matrix3d lopsided = halves;
    lopsided.col(0) = lopsided.row(0).transpose() = Vec3(1e308, 0, 0);
    expect_enclosed(rows({{0, 3 * least, 3 * least}}), origin, stretched(lopsided));
    // The product underflows in scaled units.
    const Points far = rows({{0, 0, 0}, {0x1p1000, 0, 0}});
    expect_enclosed(rows({{0x1p-20, 0, 0}}), far, stretched(0x1p-60 * Eigen::Matrix3d::Identity()));
}

TEST(SessionWidening, ATranslationThatUnderflows) {
    expect_enclosed(rows({{0, 0, 0}}), rows({{0, 0, 0}, {0x1p1000, 0, 0}}), moved_by({0x1p-100, 0, 0}));
}

// A loss in posing B must count like a loss in posing A.
TEST(SessionWidening, ATargetThatUnderflows) {
    const auto enclosed = [](const Points& a, const Points& b, const Pose& pose) {
        Query query = relative({});
        query.target_pose = pose;
        const Bounds bounds = answer(find_solver("naive"), a, b, query).bounds;
        const exact::Rational low = bounds.lower, high = bounds.upper;
        const exact::Rational squared = exact_squared_hausdorff(a, posed(b, pose));
        EXPECT_TRUE(low * low <= squared && squared <= high * high) << bounds.lower << ", " << bounds.upper;
    };
    const double least = 0x1p-1074;
    enclosed(rows({{0, 0, 0}}), rows({{least, least, least}}), stretched(0.5 * Eigen::Matrix3d::Ones()));
    enclosed(rows({{0x1p1000, 0, 0}}), rows({{0x1p1000, 0, 0}}), moved_by({0, 0x1p-100, 0}));
}

// A bit lost by scaling decides a tie, so a sum moves by one ulp.
TEST(SessionWidening, RoundingsThatGoTheOtherWay) {
    const double unit = 0x1p-1000, above = unit * (1 + 0x1p-52), half_an_ulp_and_a_bit = 0x1p-53 * (1 + 0x1p-23);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    sum.row(0) << 1, half_an_ulp_and_a_bit, 0;
    ASSERT_EQ(posed(rows({{unit, unit, 0}}), stretched(sum))(0, 0), unit);
    expect_enclosed(rows({{unit, unit, 0}}), rows({{above, 0, 0}}), stretched(sum));
    Eigen::Matrix3d little = Eigen::Matrix3d::Zero();
    little(0, 0) = half_an_ulp_and_a_bit;
    ASSERT_EQ(posed(rows({{unit, 0, 0}}), stretched(little, {unit, 0, 0}))(0, 0), unit);
    expect_enclosed(rows({{unit, 0, 0}}), rows({{above, 0, 0}}), stretched(little, {unit, 0, 0}));
}

TEST(SessionWidening, SamplesOfATraceAreWidenedToo) {
    said = {};
    said.bounds = {0.25, 0.5};
    said.status = Status::budget;
    samples = true;
    const SolverEntry entry = claims();
    const Session session(entry, defaults(entry),
                          {PointSet{rows({{0x1p1000, 0x1p-100, 0}})}, PointSet{rows({{0, 0, 0}})}}, {});
    Trace trace(Trace::Mode::on);
    const Result result = session.solve(relative({}), trace);
    samples = false;
    ASSERT_EQ(trace.samples().size(), 2u);
    EXPECT_LT(result.bounds.lower, 0x1p999);
    EXPECT_GT(result.bounds.upper, 0x1p1000);
    EXPECT_EQ(trace.samples()[0].lower, result.bounds.lower);
    EXPECT_EQ(trace.samples()[0].upper, result.bounds.upper);
}

// Scenes at the ends of the range of doubles, where many terms underflow.
TEST(SessionWidening, HoldsOnRandomScenesAtTheEndsOfTheRange) {
    Random random(77);
    const std::vector<SolverEntry> all = certified_solvers();
    const auto number = [&](int most, int spread) {
        const double mantissa = random.below(3) == 0 ? 1 + random.below(2) : random.real(1, 2);
        return (random.below(2) ? -1 : 1) *
               std::ldexp(mantissa, most - (random.below(3) ? random.below(4) : random.below(spread)));
    };
    int tried = 0;
    for (int i = 0; i < 400; ++i) {
        const int ends[] = {-1074, -1060, -1000, -500, 0, 990};
        const int end = ends[random.below(6)];
        const auto points = [&](Index n) {
            Points p(n, 3);
            for (Index k = 0; k < n; ++k)
                for (int j = 0; j < 3; ++j) p(k, j) = random.below(4) ? number(end, 1100) : 0;
            return p;
        };
        Pose pose;
        const int size = random.below(3) ? 0 : random.below(20) - 10;
        for (double& entry : pose.rotation.reshaped()) entry = random.below(3) ? number(size, 110) : 0;
        for (double& t : pose.translation) t = random.below(2) ? number(end, 1100) : 0;
        const Points a = points(1 + random.below(3));
        Points b = points(1 + random.below(3));
        const Points there = posed(a, pose);
        if (!there.allFinite()) continue;
        if (random.below(2)) b.row(0) = there.row(0);  // at distances near 0, every term matters
        ++tried;
        for (const SolverEntry& entry : all) expect_enclosed(entry, a, b, pose, ", scene " + std::to_string(i));
    }
    EXPECT_GT(tried, 300);
}

}  // namespace
}  // namespace hausbench
