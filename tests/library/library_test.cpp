// Answers of the C interface: right, with the bits of a session, from several threads, cancelled, and posed.
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/library/c_interface.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/squared_distance_3.h>
#include <gtest/gtest.h>
#include <malloc.h>
#ifdef __SSE2__
#include <xmmintrin.h>
#endif

#include <atomic>
#include <bit>
#include <cfenv>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

namespace hausbench {
namespace {

std::vector<double> numbers_of(const Points& points) { return {points.data(), points.data() + points.size()}; }
ShapeHandle handle_of(const TriangleMesh& mesh) {
    const Triangles& t = mesh.triangles;
    return shape_of(numbers_of(mesh.vertices), std::vector<std::int64_t>(t.data(), t.data() + t.size()));
}

TriangleMesh random_mesh(std::uint64_t seed, Index triangles, double size = 1) {
    Random random(seed);
    TriangleMesh mesh{cloud(random, 3 * triangles, size), Triangles(triangles, 3)};
    for (Index i = 0; i < 3 * triangles; ++i) mesh.triangles(i / 3, i % 3) = i;
    return mesh;
}

Result by_session(const char* solver, const Shape& a, const Shape& b, double tolerance) {
    const SolverEntry& entry = find_solver(solver);
    const Session session(entry, Options(entry.info.name, entry.info.parameters, {}), Scene{a, b}, {});
    Query query;
    query.tolerance.value = tolerance;
    Trace trace;
    return session.solve(query, trace);
}

void expect_same_bits(const hausbench_interval& actual, const Bounds& expected) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(actual.lower), std::bit_cast<std::uint64_t>(expected.lower));
    EXPECT_EQ(std::bit_cast<std::uint64_t>(actual.upper), std::bit_cast<std::uint64_t>(expected.upper));
}

const std::vector<double> two_points = {0, 0, 0, 3, 4, 0}, origin = {0, 0, 0};

TEST(Library, BoundsTheDistanceOfPoints) {
    const ShapeHandle a = shape_of(two_points), b = shape_of(origin);
    const hausbench_answer there = directed(pair_of(a, b)), back = directed(pair_of(b, a));
    EXPECT_EQ(there.status, HAUSBENCH_CONVERGED);
    EXPECT_LE(there.bounds.lower, 5);
    EXPECT_GE(there.bounds.upper, 5);
    EXPECT_NEAR(there.bounds.upper, there.bounds.lower, 1e-5);
    EXPECT_EQ(there.source_row, 1);
    EXPECT_EQ(there.target_row, 0);
    EXPECT_EQ(there.source_point[0], 3);
    EXPECT_EQ(there.to_source, 0);
    EXPECT_EQ(back.bounds.lower, 0);
    EXPECT_LE(back.bounds.upper, 5e-6);
}

TEST(Library, SaysWhichShapeHasTheWitness) {
    const ShapeHandle a = shape_of(two_points), b = shape_of(origin);
    const hausbench_answer one = symmetric(pair_of(a, b)), other = symmetric(pair_of(b, a));
    EXPECT_EQ(one.to_source, 0);
    EXPECT_EQ(other.to_source, 1);
    EXPECT_EQ(other.target_row, 1);
    EXPECT_EQ(other.target_point[1], 4);
    EXPECT_EQ(other.source_row, 0);
    EXPECT_EQ(one.bounds.lower, other.bounds.lower);
}

TEST(Library, HasTheBitsOfASession) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const TriangleMesh a = random_mesh(seed, 12), b = random_mesh(seed + 100, 20, seed % 3 == 0 ? 40 : 1);
        const double length = 1e-6 * diagonal(a.vertices);
        const ShapeHandle source = handle_of(a), target = handle_of(b);
        const PairHandle pair = pair_of(source, target);
        const Result there = by_session("cover", a, b, length), back = by_session("cover", b, a, length);
        expect_same_bits(directed(pair).bounds, there.bounds);
        expect_same_bits(symmetric(pair).bounds, {std::max(there.bounds.lower, back.bounds.lower),
                                                  std::max(there.bounds.upper, back.bounds.upper)});
    }
}

TEST(Library, ToleranceOfASinglePointIsAFractionOfBothShapes) {
    hausbench_query coarse = initial_query();
    coarse.tolerance = 1e-3;
    // The box of the mesh contains the point, so its diagonal is the diagonal of both.
    const TriangleMesh large = sheet(30, 0, 0.5);
    const PointSet middle{rows({Vec3(14.3, 14.2, 0)})};
    const ShapeHandle point = shape_of({14.3, 14.2, 0}), mesh = handle_of(large);
    for (const bool back : {false, true}) {
        hausbench_interval interval = directed(back ? pair_of(mesh, point) : pair_of(point, mesh), coarse).bounds;
        const double length = 1e-3 * diagonal(large.vertices);
        expect_same_bits(
            interval,
            (back ? by_session("cover", large, middle, length) : by_session("cover", middle, large, length)).bounds);
    }
    coarse.tolerance = 0.25;
    const ShapeHandle source = shape_of(origin), target = shape_of({0, 0, 0, 0, 0, 0});
    const hausbench_answer answer = directed(pair_of(source, target), coarse);  // no extent at all: a length
    EXPECT_EQ(answer.status, HAUSBENCH_CONVERGED);
    EXPECT_LE(answer.bounds.upper, 0.25);
}

TEST(Library, UnitsOfTheTolerance) {
    const TriangleMesh a = sheet(8, 0), b = sheet(8, 1, 0.4);
    const ShapeHandle source = handle_of(a), target = handle_of(b);
    const PairHandle pair = pair_of(source, target);
    hausbench_query query = initial_query();
    query.tolerance = 1e-3;
    query.relative_to = HAUSBENCH_OF_LENGTH;
    hausbench_answer answer = directed(pair, query);
    expect_same_bits(answer.bounds, by_session("cover", a, b, 1e-3).bounds);
    query.relative_to = HAUSBENCH_OF_LOWER;
    for (const bool both : {false, true}) {
        answer = both ? symmetric(pair, query) : directed(pair, query);
        EXPECT_EQ(answer.status, HAUSBENCH_CONVERGED);
        EXPECT_LE(answer.bounds.upper - answer.bounds.lower, 1e-3 * answer.bounds.lower);
    }
}

// The bounds hold, come in the thread of the caller, and end the call if the function says so.
TEST(Library, ShowsTheBoundsSoFar) {
    const PairHandle pair = pair_of(handle_of(sheet(40, 0, 0.4)), handle_of(sheet(37, 0.3, 0.4)));
    struct Seen {
        std::vector<std::vector<hausbench_interval>> bounds;
        std::thread::id thread = std::this_thread::get_id();
        int elsewhere = 0, stop = 0;

        static int keep(void* data, const hausbench_interval* bounds, std::size_t count) {
            auto& self = *static_cast<Seen*>(data);
            self.bounds.emplace_back(bounds, bounds + count);
            self.elsewhere += self.thread != std::this_thread::get_id();
            return self.stop;
        }
    };
    for (const bool both : {false, true}) {
        Seen seen;
        hausbench_query query = initial_query();
        query.progress = Seen::keep;
        query.progress_data = &seen;
        const hausbench_answer answer = both ? symmetric(pair, query) : directed(pair, query);
        const hausbench_answer plain = both ? symmetric(pair) : directed(pair);
        expect_same_bits(answer.bounds, {plain.bounds.lower, plain.bounds.upper});
        ASSERT_FALSE(seen.bounds.empty());
        EXPECT_EQ(seen.elsewhere, 0);
        for (const auto& bounds : seen.bounds) {
            ASSERT_EQ(bounds.size(), 1u);
            EXPECT_LE(bounds[0].lower, answer.bounds.upper);
            EXPECT_GE(bounds[0].upper, answer.bounds.lower);
        }
    }
    for (const int stop : {0, 1}) {
        Seen seen;
        seen.stop = stop;
        hausbench_query query = initial_query();
        query.tolerance = 1e-3;
        query.progress = Seen::keep;
        query.progress_data = &seen;
        const char* names[] = {"mean", "maximum"};
        hausbench_interval values[2];
        hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
        hausbench_error error = HAUSBENCH_ERROR_INIT;
        expect_ok(hausbench_distribution(pair.get(), names, 2, &query, values, &answer, &error), error);
        EXPECT_EQ(answer.status, stop ? HAUSBENCH_CANCELLED : HAUSBENCH_CONVERGED);
        ASSERT_GE(seen.bounds.size(), stop ? 1u : 2u);
        for (const auto& bounds : seen.bounds) {
            ASSERT_EQ(bounds.size(), 2u);
            for (int i = 0; i < 2; ++i) {
                EXPECT_LE(bounds[i].lower, values[i].upper);
                EXPECT_GE(bounds[i].upper, values[i].lower);
            }
        }
        EXPECT_LT(values[0].upper, INFINITY);
    }
}

TEST(Library, AsksWhetherADistanceIsWithinALength) {
    const ShapeHandle a = shape_of(two_points), b = shape_of(origin);
    const PairHandle pair = pair_of(a, b);
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    for (const auto& [length, status] : {std::pair{5.1, HAUSBENCH_WITHIN}, std::pair{4.9, HAUSBENCH_ABOVE}}) {
        hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
        expect_ok(hausbench_within(pair.get(), 0, length, nullptr, &answer, &error), error);
        EXPECT_EQ(answer.status, status);
        EXPECT_LE(answer.bounds.lower, 5);
        EXPECT_GE(answer.bounds.upper, 5);
    }
    for (const double bad : {-1.0, double(NAN), double(INFINITY)}) {
        hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
        EXPECT_EQ(hausbench_within(pair.get(), 0, bad, nullptr, &answer, &error), HAUSBENCH_BAD_INPUT);
        EXPECT_EQ(error.argument, 3);
    }
}

// h(A,B) = 0 and h(B,A) = 5 for A the origin, and the reverse; so H is 5 both ways.
TEST(Library, AsksWhetherTheSymmetricDistanceIsWithinALength) {
    const ShapeHandle one = shape_of(origin), two = shape_of(two_points);
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    for (const bool swapped : {false, true}) {
        const PairHandle pair = swapped ? pair_of(two, one) : pair_of(one, two);
        for (const auto& [length, status] : {std::pair{5.1, HAUSBENCH_WITHIN}, std::pair{4.9, HAUSBENCH_ABOVE}}) {
            hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
            expect_ok(hausbench_within(pair.get(), 1, length, nullptr, &answer, &error), error);
            EXPECT_EQ(answer.status, status);
            EXPECT_LE(answer.bounds.lower, 5);
            EXPECT_GE(answer.bounds.upper, 5);
            EXPECT_EQ(answer.to_source, swapped ? 0 : 1);
        }
    }
}

TEST(Library, StatisticsOfTheDistance) {
    const ShapeHandle a = shape_of(two_points), b = shape_of(origin);
    const PairHandle pair = pair_of(a, b, nullptr, HAUSBENCH_DISTRIBUTION);
    const char* names[] = {"mean", "maximum", "within 1", "mean target"};
    const double expected[] = {2.5, 5, 0.5, 0};
    hausbench_interval values[4];
    hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_distribution(pair.get(), names, 4, nullptr, values, &answer, &error), error);
    EXPECT_EQ(answer.status, HAUSBENCH_CONVERGED);
    for (int i = 0; i < 4; ++i) {
        EXPECT_LE(values[i].lower, expected[i]) << names[i];
        EXPECT_GE(values[i].upper, expected[i]) << names[i];
        EXPECT_NEAR(values[i].lower, values[i].upper, 1e-4) << names[i];
    }
    EXPECT_EQ(answer.bounds.lower, values[0].lower);
    const char* wrong[] = {"mean", "mode"};
    EXPECT_EQ(hausbench_distribution(pair.get(), wrong, 2, nullptr, values, &answer, &error), HAUSBENCH_BAD_INPUT);
    EXPECT_EQ(error.argument, 2);
    EXPECT_EQ(error.row, 1);
    EXPECT_EQ(hausbench_distribution(pair.get(), names, 0, nullptr, values, &answer, &error), HAUSBENCH_BAD_INPUT);
}

TEST(Library, StatisticsBySizeNeedASize) {
    const ShapeHandle dot = shape_of({0, 0, 0, 1, 0, 0}, {0, 0, 0, 1, 1, 1}),
                      segment = shape_of({0, 0, 0, 1, 0, 0}, {0, 1, 1}), b = shape_of(origin);
    const char* names[] = {"mean"};
    hausbench_interval values[1];
    hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
    hausbench_query by_number = HAUSBENCH_QUERY_INIT;
    by_number.weigh_by_number = 1;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    const PairHandle dots = pair_of(dot, b), segments = pair_of(segment, b);
    EXPECT_EQ(hausbench_distribution(dots.get(), names, 1, nullptr, values, &answer, &error), HAUSBENCH_BAD_INPUT);
    EXPECT_NE(std::string(error.text).find("neither area nor length"), std::string::npos) << error.text;
    expect_ok(hausbench_distribution(dots.get(), names, 1, &by_number, values, &answer, &error), error);
    EXPECT_NEAR(values[0].lower, 0.5, 1e-9);
    expect_ok(hausbench_distribution(segments.get(), names, 1, nullptr, values, &answer, &error), error);
    EXPECT_NEAR(values[0].lower, 0.5, 1e-5);
}

// --- fields ------------------------------------------------------------------------------------------------------

using Rational = CGAL::Exact_rational;
using Exact = CGAL::Simple_cartesian<Rational>;

Exact::Point_3 exact(const Points& points, Index i) { return {points(i, 0), points(i, 1), points(i, 2)}; }

Rational squared_distance(const Points& from, Index row, const TriangleMesh& to, Index triangle) {
    const Triangles& t = to.triangles;
    const Exact::Triangle_3 corners(exact(to.vertices, t(triangle, 0)), exact(to.vertices, t(triangle, 1)),
                                    exact(to.vertices, t(triangle, 2)));
    return CGAL::squared_distance(exact(from, row), corners);
}

// Points around the origin or far from it, small or large beside B, and one of them much farther.
struct Cloud {
    double size, away, farthest;
};
class LibraryFields : public testing::TestWithParam<Cloud> {};

TEST_P(LibraryFields, HoldUnderRounding) {
    const auto [size, away, farthest] = GetParam();
    Random random(5);
    Points from = cloud(random, 200, size);
    from.rowwise() += Eigen::RowVector3d(away, away, -away);
    from.row(199) *= farthest;
    TriangleMesh to = random_mesh(6, 12);
    to.vertices.rowwise() += Eigen::RowVector3d(away, away, -away);
    const ShapeHandle a = shape_of(numbers_of(from)), b = handle_of(to);
    std::vector<hausbench_interval> values(200);
    std::vector<std::int64_t> nearest(200, -7);
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_field(pair_of(a, b).get(), nullptr, values.data(), nearest.data(), &error), error);
    for (Index i = 0; i < 200; ++i) {
        Rational least = squared_distance(from, i, to, 0);
        for (Index t = 1; t < 12; ++t) least = std::min(least, squared_distance(from, i, to, t));
        const auto [lower, upper] = values[std::size_t(i)];
        EXPECT_LE(Rational(lower) * Rational(lower), least);
        EXPECT_GE(Rational(upper) * Rational(upper), least);
        const double magnitude = std::max({1.0, size, away, from.row(i).cwiseAbs().maxCoeff()});
        if (farthest < 1e200) {  // else squares of the others underflow
            EXPECT_LE(upper - lower, 1e-12 * magnitude);
        }
        const std::int64_t row = nearest[std::size_t(i)];
        ASSERT_TRUE(row >= 0 && row < 12);
        EXPECT_LE(squared_distance(from, i, to, Index(row)), Rational(upper) * Rational(upper));
    }
}

INSTANTIATE_TEST_SUITE_P(Sizes, LibraryFields,
                         testing::Values(Cloud{1, 0, 1}, Cloud{1e-9, 0, 1}, Cloud{1e9, 0, 1}, Cloud{1, 1e6, 1},
                                         Cloud{1, 0, 1e100}, Cloud{1, 0, 1e300}));

TEST(Library, FieldsCoverVerticesThatNoFaceUses) {
    const ShapeHandle mesh = shape_of({9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 1, 0, -5, 0, 0}, {1, 2, 3});
    const ShapeHandle b = shape_of(origin);
    const PairHandle pair = pair_of(mesh, b);
    std::vector<hausbench_interval> values(5);
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_field(pair.get(), nullptr, values.data(), nullptr, &error), error);
    const double expected[] = {std::sqrt(243.0), 0, 1, 1, 5};
    for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(values[i].upper, expected[i], 1e-12) << i;
    EXPECT_LE(directed(pair).bounds.upper, 1 + 1e-5);  // the unused vertices are no part of the mesh
}

TEST(Library, FieldsThatRunOutOfTimeHold) {
    const ShapeHandle a = shape_of(two_points), b = shape_of(origin);
    hausbench_query query = initial_query();
    query.time_limit = 0;
    std::vector<hausbench_interval> values(2);
    std::vector<std::int64_t> nearest(2);
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_field(pair_of(a, b).get(), &query, values.data(), nearest.data(), &error), error);
    EXPECT_EQ(values[1].lower, 0);
    EXPECT_EQ(values[1].upper, INFINITY);
    EXPECT_EQ(nearest[1], -1);
}

// --- poses and chains --------------------------------------------------------------------------------------------

std::array<double, 16> moved_by(double x, double y, double z) {
    return {1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z, 0, 0, 0, 1};
}

TEST(Library, PosesMoveEitherShape) {
    const ShapeHandle a = shape_of(origin), b = shape_of(origin);
    const PairHandle pair = pair_of(a, b);
    const auto away = moved_by(3, 4, 0);
    hausbench_query query = initial_query();
    query.source_pose = away.data();
    EXPECT_NEAR(directed(pair, query).bounds.upper, 5, 1e-5);
    EXPECT_NEAR(symmetric(pair, query).bounds.lower, 5, 1e-5);
    query.target_pose = away.data();
    EXPECT_NEAR(directed(pair, query).bounds.upper, 0, 1e-5);
    query.source_pose = nullptr;
    EXPECT_NEAR(symmetric(pair, query).bounds.upper, 5, 1e-5);
    // h(B,A) is the larger direction: A moves to (-3, -4, 0), and (3, 4, 0) of B is 10 away.
    const auto back = moved_by(-3, -4, 0);
    const ShapeHandle c = shape_of(two_points);
    query = initial_query();
    query.source_pose = back.data();
    EXPECT_NEAR(symmetric(pair_of(a, c), query).bounds.lower, 10, 1e-4);
    query = initial_query();
    query.target_pose = back.data();
    EXPECT_NEAR(symmetric(pair_of(a, c), query).bounds.upper, 5, 1e-4);
}

TEST(Library, ChainsGiveTrueBounds) {
    const ShapeHandle a = handle_of(sheet(10, 0, 0.3)), b = handle_of(sheet(12, 1, 0.2));
    const PairHandle pair = pair_of(a, b);
    hausbench_chain* begun = nullptr;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_chain_begin(pair.get(), &begun, &error), error);
    const ChainHandle chain(begun);
    for (int step = 0; step < 8; ++step) {
        const auto pose = moved_by(0.01 * step, 0.02 * step, 0);
        hausbench_query query = initial_query();
        query.source_pose = pose.data();
        const hausbench_answer cold = directed(pair, query), cold_both = symmetric(pair, query);
        query.chain = chain.get();
        const hausbench_answer warm = directed(pair, query), both = symmetric(pair, query);
        EXPECT_EQ(warm.status, HAUSBENCH_CONVERGED);
        EXPECT_LE(warm.bounds.lower, cold.bounds.upper);
        EXPECT_GE(warm.bounds.upper, cold.bounds.lower);
        EXPECT_LE(both.bounds.lower, cold_both.bounds.upper);
        EXPECT_GE(both.bounds.upper, cold_both.bounds.lower);
    }
    hausbench_query query = initial_query();
    query.chain = chain.get();
    hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
    EXPECT_EQ(hausbench_directed(pair_of(a, b).get(), &query, &answer, &error), HAUSBENCH_BAD_INPUT);
}

TEST(Library, APairOutlivesItsShapesAndAChainItsPair) {
    hausbench_chain* begun = nullptr;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    PairHandle pair;
    {
        const ShapeHandle a = shape_of(two_points), b = shape_of(origin);
        pair = pair_of(a, b);
    }
    EXPECT_NEAR(directed(pair).bounds.upper, 5, 1e-4);
    expect_ok(hausbench_chain_begin(pair.get(), &begun, &error), error);
    pair.reset();
    hausbench_chain_release(begun);
    hausbench_chain_release(nullptr);
    hausbench_pair_release(nullptr);
    hausbench_shape_release(nullptr);
}

// --- cancelling, threads, the caller's arithmetic ----------------------------------------------------------------

TEST(Interrupt, OnlyItsOwnThreadCallsTheHook) {
    struct Seen {
        int calls = 0, rounding = -1;
    } seen;
    const auto hook = [](void* data) {
        auto& record = *static_cast<Seen*>(data);
        ++record.calls;
        record.rounding = std::fegetround();
        return 1;
    };
    const Interrupt interrupt(hook, &seen);
    bool before = true, after = false;
    std::thread([&] { before = interrupt.stop_requested(); }).join();
    EXPECT_FALSE(before);
    EXPECT_EQ(seen.calls, 0);
    std::fesetround(FE_UPWARD);
    const bool stop = Deadline(infinity, &interrupt).passed();
    const int rounding = std::fegetround();
    std::fesetround(FE_TONEAREST);
    EXPECT_TRUE(stop);
    EXPECT_EQ(rounding, FE_UPWARD);
    EXPECT_EQ(seen.rounding, FE_TONEAREST);
    std::thread([&] { after = interrupt.stop_requested(); }).join();
    EXPECT_TRUE(after);
    EXPECT_FALSE(Deadline(infinity).passed());
}

struct Cancelling {
    std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();
    std::thread::id thread = std::this_thread::get_id();
    int calls = 0, elsewhere = 0, not_to_nearest = 0;
    double stopped = INFINITY;  // when it asked to stop, in seconds of this thread's processor time

    static double processor_seconds() {
        std::timespec now{};
        ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
        return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
    }

    static double seconds_since(std::chrono::steady_clock::time_point begin) {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    }
    static int after_50_ms(void* data) {
        auto& self = *static_cast<Cancelling*>(data);
        ++self.calls;
        self.elsewhere += self.thread != std::this_thread::get_id();
        self.not_to_nearest += std::fegetround() != FE_TONEAREST;
        const bool stop = seconds_since(self.begin) > 0.05;
        if (stop) self.stopped = processor_seconds();
        return stop;
    }
};

void expect_cancelled(const std::function<hausbench_answer(const hausbench_query&)>& ask, int threads) {
    Cancelling cancelling;
    hausbench_query query = initial_query();
    query.threads = threads;
    query.tolerance = 1e-12;
    query.share_tolerance = 1e-12;
    query.cancel = Cancelling::after_50_ms;
    query.cancel_data = &cancelling;
    const hausbench_answer answer = ask(query);
    EXPECT_LT(Cancelling::processor_seconds() - cancelling.stopped,
              0.1);  // wall time depends on the load
    EXPECT_EQ(answer.status, HAUSBENCH_CANCELLED);
    EXPECT_LE(answer.bounds.lower, answer.bounds.upper);
    EXPECT_GT(cancelling.calls, 1);
    EXPECT_EQ(cancelling.elsewhere, 0);
    EXPECT_EQ(cancelling.not_to_nearest, 0);
}

TEST(Library, CancelsALongCall) {
    Random random(1);
    const ShapeHandle a = shape_of(numbers_of(cloud(random, 60000))), b = shape_of(numbers_of(cloud(random, 60000)));
    const PairHandle points = pair_of(a, b, "naive");
    expect_cancelled([&](const hausbench_query& query) { return directed(points, query); }, 1);
    expect_cancelled([&](const hausbench_query& query) { return symmetric(points, query); }, 1);
    const ShapeHandle c = handle_of(sheet(40, 0, 0.4)), d = handle_of(sheet(37, 0.3, 0.4));
    const PairHandle meshes = pair_of(c, d, nullptr, HAUSBENCH_DISTRIBUTION);
    for (const int threads : {1, 2})
        expect_cancelled(
            [&](const hausbench_query& query) {
                const char* names[] = {"mean", "median"};
                hausbench_interval values[2];
                hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
                hausbench_error error = HAUSBENCH_ERROR_INIT;
                expect_ok(hausbench_distribution(meshes.get(), names, 2, &query, values, &answer, &error), error);
                return answer;
            },
            threads);
}

// The hook asks to stop when it is first called, which is while structures are built. The pair answers later calls.
TEST(Library, CancelsPreparing) {
    const auto new_pair = [](const char* solver) {
        return pair_of(handle_of(sheet(60, 0, 0.4)), handle_of(sheet(57, 0.3, 0.4)), solver, HAUSBENCH_NOTHING);
    };
    struct Ask {
        const char* solver;
        int threads;
        bool moved;
    };
    for (const auto [solver, threads, moved] :
         {Ask{"cover", 1, false}, Ask{"cover", 2, false}, Ask{"guthe", 1, false}, Ask{"cover", 1, true}}) {
        const PairHandle pair = new_pair(solver);
        const auto far = moved_by(1e200, 0, 0);
        int calls = 0;
        hausbench_query query = initial_query();
        query.threads = threads;
        if (moved) query.source_pose = query.target_pose = far.data();
        if (moved) directed(pair, query);  // so that only the structures of this pose are left to build
        query.cancel_data = &calls;
        query.cancel = [](void* data) { return ++*static_cast<int*>(data); };
        const hausbench_answer stopped = directed(pair, query);
        EXPECT_EQ(stopped.status, HAUSBENCH_CANCELLED) << solver << ", " << threads << ", " << moved;
        EXPECT_EQ(stopped.bounds.lower, 0);
        EXPECT_EQ(stopped.bounds.upper, INFINITY);
        EXPECT_EQ(stopped.solve_seconds, 0);
        EXPECT_EQ(calls, 1);
        query.cancel = nullptr;
        EXPECT_LT(directed(pair, query).bounds.upper, INFINITY) << solver;
    }
    std::vector<hausbench_interval> values(61 * 61);
    std::vector<std::int64_t> nearest(61 * 61);
    hausbench_query query = initial_query();
    query.cancel = [](void*) { return 1; };
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_field(new_pair("cover").get(), &query, values.data(), nearest.data(), &error), error);
    EXPECT_EQ(values[7].upper, INFINITY);
    EXPECT_EQ(nearest[7], -1);
}

// A cancel function may ask about the same pair, or about another pair of the same shapes, while structures are built.
TEST(Library, ACancelFunctionMayAsk) {
    const ShapeHandle a = handle_of(sheet(60, 0, 0.4)), b = handle_of(sheet(57, 0.3, 0.4));
    struct Inner {
        const ShapeHandle *a, *b;
        hausbench_pair* pair;
        int calls = 0;
        double upper = 0;
        bool inside = false;
    };
    for (const bool other : {false, true}) {
        const PairHandle pair = pair_of(a, b, other ? "guthe" : "cover", HAUSBENCH_NOTHING);
        Inner inner{&a, &b, pair.get()};
        hausbench_query query = initial_query();
        query.cancel_data = &inner;
        query.cancel = [](void* data) {
            auto& self = *static_cast<Inner*>(data);
            EXPECT_FALSE(self.inside);
            if (++self.calls > 1) return 0;
            self.inside = true;
            std::this_thread::sleep_for(std::chrono::milliseconds(3));  // from now on the interrupt would ask again
            const PairHandle again = pair_of(*self.a, *self.b);
            hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
            hausbench_error error = HAUSBENCH_ERROR_INIT;
            expect_ok(hausbench_directed(self.pair, nullptr, &answer, &error), error);
            EXPECT_EQ(directed(again).status, HAUSBENCH_CONVERGED);
            self.upper = answer.bounds.upper;
            self.inside = false;
            return 0;
        };
        const hausbench_answer outer = directed(pair, query);
        EXPECT_EQ(outer.status, HAUSBENCH_CONVERGED);
        EXPECT_EQ(outer.bounds.upper, inner.upper);
        EXPECT_GE(inner.calls, 1);
    }
}

TEST(Library, EndsAtTheTimeLimit) {
    Random random(1);
    const ShapeHandle a = shape_of(numbers_of(cloud(random, 60000))), b = shape_of(numbers_of(cloud(random, 60000)));
    hausbench_query query = initial_query();
    query.time_limit = 0.01;
    EXPECT_EQ(directed(pair_of(a, b, "naive"), query).status, HAUSBENCH_TIME_LIMIT);
}

TEST(Library, SeveralThreadsMayShareAPair) {
    const ShapeHandle a = handle_of(sheet(12, 0, 0.3)), b = handle_of(sheet(13, 1, 0.3));
    const PairHandle alone = pair_of(a, b), shared = pair_of(a, b, nullptr, HAUSBENCH_NOTHING);
    const hausbench_answer forward = directed(alone), both = symmetric(alone);
    std::atomic<int> different{0};
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&] {
            for (int i = 0; i < 10; ++i) {
                const PairHandle fresh = pair_of(b, a);  // over the same shapes
                different += directed(shared).bounds.lower != forward.bounds.lower;
                different += symmetric(shared).bounds.upper != both.bounds.upper;
                different += symmetric(fresh).bounds.upper != both.bounds.upper;
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(different, 0);
}

#ifdef __SSE2__
TEST(Library, DoesNotDependOnTheArithmeticOfTheCaller) {
    const ShapeHandle a = handle_of(random_mesh(1, 20, 1e-310)), b = handle_of(random_mesh(2, 20, 1e-310));
    const hausbench_answer expected = directed(pair_of(a, b));
    const unsigned before = _mm_getcsr();
    _mm_setcsr((before & ~0x6000u) | 0x8040u | 0x4000u);  // subnormal numbers are 0, rounding upward
    const unsigned set = _mm_getcsr() & 0xe040u;
    const hausbench_answer answer = directed(pair_of(a, b));
    const unsigned after = _mm_getcsr() & 0xe040u;
    _mm_setcsr(before);
    EXPECT_EQ(after, set);
    expect_same_bits(answer.bounds, {expected.bounds.lower, expected.bounds.upper});
    EXPECT_GT(expected.bounds.lower, 0);
}
#endif

TEST(Library, GivesItsMemoryBack) {
    const auto use = [] {
        const ShapeHandle a = handle_of(sheet(4, 0)), b = handle_of(sheet(4, 1));
        const PairHandle pair = pair_of(a, b);
        directed(pair);
        symmetric(pair);
    };
    for (int i = 0; i < 20; ++i) use();
    const std::size_t before = ::mallinfo2().uordblks;
    for (int i = 0; i < 500; ++i) use();
    EXPECT_LE(::mallinfo2().uordblks, before + 10'000);
}

// Sources of many sizes: each scales the target anew.
TEST(Library, KeepsFewScaledCopies) {
    const ShapeHandle target = handle_of(sheet(60, 0, 0.4));
    const auto ask = [&](int exponent) { directed(pair_of(shape_of({0, 0, std::ldexp(1, exponent)}), target)); };
    for (int exponent = 10; exponent < 15; ++exponent) ask(exponent);
    const std::size_t before = ::mallinfo2().uordblks;
    for (int exponent = 15; exponent < 30; ++exponent) ask(exponent);
    EXPECT_LE(::mallinfo2().uordblks, before + 100'000);
}

// --- files -------------------------------------------------------------------------------------------------------

std::string written(const TemporaryFolder& folder, const std::string& name, const std::string& text) {
    const std::string file = folder.path() / name;
    std::ofstream(file) << text;
    return file;
}

std::vector<double> vertices_of(const ShapeHandle& shape) {
    std::vector<double> numbers(std::size_t(3 * description_of(shape).vertices));
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_copy_out(shape.get(), numbers.data(), nullptr, &error), error);
    return numbers;
}

std::vector<std::string> notes_of(const ShapeHandle& shape) {
    std::vector<std::string> notes;
    while (const char* note = hausbench_note(shape.get(), notes.size())) notes.emplace_back(note);
    return notes;
}

// Returns the text of the error with which two shapes are refused.
std::string refused_pair(const ShapeHandle& a, const ShapeHandle& b) {
    auto* const untouched = reinterpret_cast<hausbench_pair*>(std::uintptr_t{8});
    hausbench_pair* pair = untouched;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    EXPECT_EQ(hausbench_prepare(a.get(), b.get(), nullptr, &pair, &error), HAUSBENCH_BAD_INPUT);
    EXPECT_EQ(pair, untouched);
    EXPECT_EQ(error.argument, 2);
    return error.text;
}

constexpr const char* one_triangle = "OFF\n3 1 0\n0 0 0\n1 2 0\n0 1 3\n3 0 1 2\n";

TEST(LibraryFiles, WithoutOptionsTheNumbersCount) {
    const TemporaryFolder folder;
    const std::string file = written(folder, "a.off", one_triangle);
    hausbench_shape* plain = nullptr;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    expect_ok(hausbench_read(file.c_str(), &plain, &error), error);
    hausbench_shape* null = nullptr;
    expect_ok(hausbench_read_with(file.c_str(), nullptr, &null, &error), error);
    const ShapeHandle first(plain), second(null), third = read_shape(file);
    const std::vector<double> expected = {0, 0, 0, 1, 2, 0, 0, 1, 3};
    for (const ShapeHandle* shape : {&first, &second, &third}) {
        EXPECT_EQ(vertices_of(*shape), expected);
        const hausbench_description about = description_of(*shape);
        EXPECT_EQ(about.faces, 1);
        EXPECT_EQ(about.unit, 0);
        EXPECT_EQ(about.up, 0);
        EXPECT_EQ(about.segments + about.single_points + about.dropped_points + about.dropped_faces, 0);
        EXPECT_TRUE(notes_of(*shape).empty());
    }
}

TEST(LibraryFiles, TheFormatMayBeNamed) {
    const TemporaryFolder folder;
    const std::string file = written(folder, "a.obj", one_triangle);
    hausbench_read_options options = initial_options();
    options.format = "off";
    EXPECT_EQ(description_of(read_shape(file, options)).faces, 1);
}

TEST(LibraryFiles, AFileWithoutUnitOrAxesCountsAsHavingTheOptions) {
    const TemporaryFolder folder;
    const std::string file = written(folder, "a.off", one_triangle);
    hausbench_read_options options = initial_options();
    options.unit = "Inches";
    options.up = "y";
    const ShapeHandle shape = read_shape(file, options);
    EXPECT_EQ(vertices_of(shape), (std::vector<double>{0, 0, 0, 1, 2, 0, 0, 1, 3}));
    EXPECT_EQ(description_of(shape).unit, 0.0254);
    EXPECT_EQ(description_of(shape).up, 'Y');
    const std::vector<std::string> notes = notes_of(shape);
    ASSERT_EQ(notes.size(), 2u);
    EXPECT_NE(notes[0].find("inch"), std::string::npos) << notes[0];
    EXPECT_NE(notes[1].find("Y"), std::string::npos) << notes[1];
    EXPECT_EQ(hausbench_note(shape.get(), std::size_t(-1)), nullptr);
    EXPECT_EQ(hausbench_note(nullptr, 0), nullptr);
    options.unit = "none";
    options.up = "NONE";
    const ShapeHandle without = read_shape(file, options);
    EXPECT_EQ(description_of(without).unit, 0);
    EXPECT_EQ(description_of(without).up, 0);
    EXPECT_TRUE(notes_of(without).empty());
}

// 1 inch is 25.4 mm. AMF states no axes.
TEST(LibraryFiles, TheUnitOfAFileIsConverted) {
    const TemporaryFolder folder;
    std::string text = "<amf unit=\"inch\"><object id=\"0\"><mesh><vertices>";
    for (const char* at : {"<x>0</x><y>0</y><z>0</z>", "<x>1</x><y>2</y><z>0</z>", "<x>0</x><y>1</y><z>3</z>"})
        text += "<vertex><coordinates>" + std::string(at) + "</coordinates></vertex>";
    text += "</vertices><volume><triangle><v1>0</v1><v2>1</v2><v3>2</v3></triangle></volume></mesh></object></amf>";
    const std::string file = written(folder, "a.amf", text);
    const ShapeHandle inches = read_shape(file);
    EXPECT_EQ(description_of(inches).unit, 0.0254);
    EXPECT_EQ(vertices_of(inches)[4], 2);
    hausbench_read_options options = initial_options();
    options.unit = "mm";
    const ShapeHandle millimetres = read_shape(file, options);
    EXPECT_EQ(description_of(millimetres).unit, 0.001);
    EXPECT_EQ(vertices_of(millimetres)[4], 2 * 25.4);
    refused_pair(inches, millimetres);
    options.unit = "none";
    const ShapeHandle numbers = read_shape(file, options);
    EXPECT_EQ(vertices_of(numbers), vertices_of(inches));
    EXPECT_EQ(description_of(numbers).unit, 0);
    EXPECT_NEAR(directed(pair_of(inches, numbers)).bounds.upper, 0, 1e-5);  // one of them states no unit
}

TEST(LibraryFiles, ShapesInDifferentUnitsAreNoPair) {
    const TemporaryFolder folder;
    const std::string file = written(folder, "a.off", one_triangle), other = written(folder, "b.off", one_triangle);
    hausbench_read_options options = initial_options();
    options.unit = "inch";
    const ShapeHandle inches = read_shape(file, options);
    options.unit = "m";
    const ShapeHandle metres = read_shape(other, options), plain = read_shape(other);
    const std::string text = refused_pair(inches, metres);
    for (const std::string part : {"a.off) is in inch", "b.off) in m", "unit=\"mm\"", "\"none\""})
        EXPECT_NE(text.find(part), std::string::npos) << text;
    EXPECT_EQ(directed(pair_of(inches, plain)).bounds.lower, 0);
    EXPECT_EQ(directed(pair_of(metres, plain)).bounds.lower, 0);
    EXPECT_EQ(directed(pair_of(metres, metres)).bounds.lower, 0);
}

TEST(LibraryFiles, ShapesWithDifferentAxesAreNoPair) {
    const TemporaryFolder folder;
    const std::string file = written(folder, "a.off", one_triangle);
    hausbench_read_options options = initial_options();
    options.up = "Z";
    const ShapeHandle z = read_shape(file, options);
    options.up = "Y";
    const ShapeHandle y = read_shape(file, options), plain = read_shape(file);
    const std::string text = refused_pair(z, y);
    for (const std::string part : {"Z points up in A", "Y in B", "up=\"Z\"", "\"none\""})
        EXPECT_NE(text.find(part), std::string::npos) << text;
    EXPECT_EQ(directed(pair_of(z, plain)).bounds.lower, 0);
    EXPECT_EQ(directed(pair_of(z, z)).bounds.lower, 0);
}

TEST(LibraryFiles, PointsThatAreNotFiniteAreDroppedIfAskedFor) {
    const TemporaryFolder folder;
    const std::string file = written(folder, "a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\nnan 0 0\n3 0 1 2\n3 0 1 3\n");
    hausbench_read_options options = initial_options();
    options.drop_invalid = 1;
    const hausbench_description about = description_of(read_shape(file, options));
    EXPECT_EQ(about.faces, 1);
    EXPECT_EQ(about.dropped_points, 1);
    EXPECT_EQ(about.dropped_faces, 1);
    options.drop_invalid = 0;
    hausbench_shape* shape = nullptr;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    EXPECT_EQ(hausbench_read_with(file.c_str(), &options, &shape, &error), HAUSBENCH_BAD_INPUT);
    EXPECT_EQ(error.argument, 1);
}

TEST(LibraryFiles, SurfacesAreReadByTheProgramAlone) {
    const TemporaryFolder folder;
    hausbench_shape* shape = nullptr;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    const std::string file = written(folder, "a.surface.toml", "x = 1\n");
    EXPECT_EQ(hausbench_read(file.c_str(), &shape, &error), HAUSBENCH_BAD_INPUT);
    EXPECT_NE(std::string(error.text).find("algebraic surfaces are read by the program alone"), std::string::npos)
        << error.text;
}

// A US survey foot is no unit with a name: 1200/3937 m.
TEST(LibraryFiles, ArraysMayStateAUnit) {
    for (const double unit : {0.001, 0.0254, 1200.0 / 3937, 1e-300, 0.0}) {
        hausbench_description about = HAUSBENCH_DESCRIPTION_INIT;
        about.segments = 1, about.single_points = 2, about.dropped_points = 3, about.dropped_faces = 4;
        about.unit = unit;
        about.up = 'X';
        const hausbench_array v = array_of(two_points);
        hausbench_shape* made = nullptr;
        hausbench_error error = HAUSBENCH_ERROR_INIT;
        expect_ok(hausbench_shape_stating(&v, nullptr, &about, &made, &error), error);
        const ShapeHandle first(made);
        const hausbench_description description = description_of(first);
        EXPECT_EQ(description.unit, unit);
        EXPECT_EQ(description.up, 'X');
        EXPECT_EQ(description.segments, 1);
        EXPECT_EQ(description.single_points, 2);
        EXPECT_EQ(description.dropped_points, 3);
        EXPECT_EQ(description.dropped_faces, 4);
        expect_ok(hausbench_shape_stating(&v, nullptr, &description, &made, &error), error);
        const ShapeHandle second(made);
        EXPECT_EQ(directed(pair_of(first, second)).bounds.lower, 0);
        about.unit = 0.5;
        expect_ok(hausbench_shape_stating(&v, nullptr, &about, &made, &error), error);
        const ShapeHandle other(made);
        if (unit > 0) {
            EXPECT_NE(refused_pair(first, other).find("A (arrays) is in "), std::string::npos);
        }
    }
}

// --- certificates ------------------------------------------------------------------------------------------------

TEST(Library, CertificatesAreWrittenAndChecked) {
    const TemporaryFolder folder;
    const std::string file = folder.path() / "proof";
    const ShapeHandle a = handle_of(sheet(5, 0, 0.2)), b = handle_of(sheet(6, 1, 0.2));
    const PairHandle pair = pair_of(a, b);
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    for (const int both : {0, 1}) {
        hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
        expect_ok(hausbench_certify(pair.get(), both, nullptr, file.c_str(), &answer, &error), error);
        EXPECT_EQ(answer.bounds.upper, (both ? symmetric(pair) : directed(pair)).bounds.upper);
        hausbench_verdict verdict = HAUSBENCH_VERDICT_INIT;
        expect_ok(hausbench_verify(file.c_str(), a.get(), b.get(), &verdict, &error), error);
        EXPECT_EQ(verdict.accepted, 1) << verdict.text;
        // The file states what it proves, which may be a little more than the bound of the answer.
        EXPECT_EQ(verdict.bounds.upper, std::max(answer.bounds.upper, verdict.proven));
        EXPECT_NEAR(verdict.proven, answer.bounds.upper, 1e-9);
        EXPECT_EQ(hausbench_verify(file.c_str(), b.get(), a.get(), &verdict, &error), HAUSBENCH_BAD_INPUT);
    }
    std::fstream damaged(file, std::ios::in | std::ios::out | std::ios::binary);
    damaged.seekp(40).put('!');
    damaged.close();
    hausbench_verdict verdict = HAUSBENCH_VERDICT_INIT;
    EXPECT_EQ(hausbench_verify(file.c_str(), a.get(), b.get(), &verdict, &error), HAUSBENCH_BAD_INPUT);
}

// A proof about a pose says nothing about the shapes at rest.
TEST(Library, AProofIsAcceptedAtItsPosesAlone) {
    const TemporaryFolder folder;
    const std::string file = folder.path() / "proof";
    const ShapeHandle a = handle_of(sheet(5, 0, 0.2)), b = handle_of(sheet(6, 1, 0.2));
    const PairHandle pair = pair_of(a, b);
    const double lowered[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.75, 0, 0, 0, 1},
                 rest[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    hausbench_query query = HAUSBENCH_QUERY_INIT;
    query.source_pose = lowered;
    hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
    expect_ok(hausbench_certify(pair.get(), 0, &query, file.c_str(), &answer, &error), error);
    const auto verdict_at = [&](const double* source, const double* target) {
        hausbench_verdict verdict = HAUSBENCH_VERDICT_INIT;
        expect_ok(hausbench_verify_posed(file.c_str(), a.get(), b.get(), source, target, &verdict, &error), error);
        EXPECT_TRUE(std::equal(lowered, lowered + 16, verdict.source_pose));
        EXPECT_TRUE(std::equal(rest, rest + 16, verdict.target_pose));
        EXPECT_EQ(verdict.proven == INFINITY, verdict.accepted == 0);
        return verdict;
    };
    EXPECT_EQ(verdict_at(lowered, nullptr).accepted, 1);
    EXPECT_EQ(verdict_at(lowered, rest).accepted, 1);
    EXPECT_EQ(verdict_at(nullptr, nullptr).accepted, 0);
    EXPECT_EQ(verdict_at(lowered, lowered).accepted, 0);
    EXPECT_NE(std::string(verdict_at(rest, nullptr).text).find("about A at another pose"), std::string::npos);
    hausbench_verdict verdict = HAUSBENCH_VERDICT_INIT;
    expect_ok(hausbench_verify(file.c_str(), a.get(), b.get(), &verdict, &error), error);
    EXPECT_EQ(verdict.accepted, 0);
    const double wrong[16] = {};
    EXPECT_EQ(hausbench_verify_posed(file.c_str(), a.get(), b.get(), wrong, nullptr, &verdict, &error),
              HAUSBENCH_BAD_INPUT);
}

TEST(Library, NoCertificateIsWrittenWithoutAProof) {
    const TemporaryFolder folder;
    const std::string file = folder.path() / "proof";
    const ShapeHandle a = shape_of(two_points), b = shape_of(origin);
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    hausbench_answer answer = HAUSBENCH_ANSWER_INIT;
    EXPECT_EQ(hausbench_certify(pair_of(a, b, "naive").get(), 0, nullptr, file.c_str(), &answer, &error),
              HAUSBENCH_BAD_INPUT);
    EXPECT_NE(std::string(error.text).find("cover"), std::string::npos) << error.text;
    // This pose shrinks A, so it cannot be proven: the checker accepts only rotations and translations.
    const std::array<double, 16> smaller = {0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1};
    hausbench_query query = initial_query();
    query.source_pose = smaller.data();
    const ShapeHandle c = handle_of(sheet(9, 0, 0.2)), d = handle_of(sheet(8, 1, 0.2));
    EXPECT_EQ(hausbench_certify(pair_of(c, d).get(), 0, &query, file.c_str(), &answer, &error), HAUSBENCH_BAD_INPUT);
    EXPECT_NE(std::string(error.text).find("rotation"), std::string::npos) << error.text;
    EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace hausbench
