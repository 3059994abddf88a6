// The certified solver on 200 pairs of quadrics of every kind, against a reference that shares no code with it; on some
// pairs, surface_meshes too.
#include "algorithms/error.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/quadric_reference.h"
#include "tests/support/searches.h"

#include <map>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using quadric_reference::Range;

Result solve(const std::string& solver, const Scene& scene, double tolerance, const ParameterMap& given = {}) {
    const SolverEntry& entry = find_solver(solver);
    Query query;
    query.tolerance = {Tolerance::Of::absolute, tolerance};
    query.time_limit = 30;
    Trace trace;
    return Session(entry, Options(entry.info.name, entry.info.parameters, given), scene, {}).solve(query, trace);
}

Quadric diagonal(const Vec3& form, const Vec3& linear, double constant) {
    Quadric q;
    q.form.diagonal() = form;
    q.linear = linear;
    q.constant = constant;
    return q;
}

TEST(QuadricReference, HoldsWhatIsKnown) {
    const Vec3 none = Vec3::Zero(), up(0, 0, 1);
    const Quadric ball = diagonal(Vec3::Ones(), none, -1), large = diagonal(Vec3::Ones(), none, -2.25);
    const Quadric cone_1 = diagonal({0.25, 0.25, -1.0 / 9}, none, 0),
                  cone_2 = diagonal({0.0625, 0.25, -1.0 / 9}, none, 0);
    const Quadric plane = diagonal(none, up, 0), above = diagonal(none, up, -0.5);
    struct Known {
        Quadric a, b;
        double h, precision;
    };
    const Known cases[] = {{cone_1, cone_2, 0.79885958582385, 0.02},
                           {cone_2, cone_1, std::sqrt(43.0) / 3 - 4.0 / 3, 0.02},
                           {plane, ball, std::sqrt(8.0) - 1, 0.02},
                           {ball, plane, 1, 0.02},
                           {ball, large, 0.5, 0.15},
                           {plane, above, 0.5, 0.15}};  // constant over A, so many boxes are visited
    for (std::size_t i = 0; i < std::size(cases); ++i) {
        const auto& [a, b, h, precision] = cases[i];
        const auto range = quadric_reference::hausdorff(a, b, precision, 20000);
        ASSERT_TRUE(range) << i;
        EXPECT_LE(range->lower, h + 1e-9) << i;
        EXPECT_GE(range->upper, h - 1e-9) << i;
        EXPECT_LE(range->upper - range->lower, precision) << i;
    }
    EXPECT_TRUE(quadric_reference::empty(diagonal(none, up, -3)));
    EXPECT_FALSE(quadric_reference::empty(above));
}

TEST(SurfaceSolvers, RandomQuadricPairs) {
    const int pairs = tries(200);
    constexpr double precision = 0.02, tolerance = 0.01;
    Random random(11);
    std::map<std::string, int> kinds;
    Counters work;
    int empty = 0, unknown = 0, sharp = 0, converged = 0, swapped_apart = 0, published_misses = 0, done = 0, closed = 0;
    for (int i = 0; done < pairs; ++i) {
        ASSERT_LT(i, 3 * pairs);
        // In turn, every kind of A meets every kind of B.
        const Quadric a = random_quadric(random, i), b = random_quadric(random, i + i / 11);
        const std::string where = a.kind + " " + a.text + " to " + b.kind + " " + b.text;
        const Scene scene{a.surface(), b.surface()};
        if (quadric_reference::empty(a) || quadric_reference::empty(b)) {
            ++empty;
            EXPECT_THROW(solve("surface_enclosure", scene, tolerance), InputError) << where;
            continue;
        }
        const auto h = quadric_reference::hausdorff(a, b, precision, 20000);
        if (!h) {
            ++unknown;
            continue;
        }
        ++done, ++kinds[a.kind], ++kinds[b.kind];
        sharp += h->upper - h->lower <= 1.01 * precision;
        const Result result = solve("surface_enclosure", scene, tolerance);
        EXPECT_LE(result.bounds.lower, h->upper) << where;
        EXPECT_GE(result.bounds.upper, h->lower) << where;
        EXPECT_LE(result.bounds.lower, result.bounds.upper) << where;
        work.subdivisions += result.counters.subdivisions, work.queue_pushes += result.counters.queue_pushes;
        if (result.status == Status::converged) {
            ++converged;
            EXPECT_LE(result.bounds.gap(), tolerance) << where;
        } else {
            fmt::print("{}: [{}, {}], {} {}\n", where, result.bounds.lower, result.bounds.upper,
                       to_string(result.status), result.note);
        }
        if (done % 10 == 0) {  // the other direction has another distance, and this test would notice a swap
            const Result other = solve("surface_enclosure", {b.surface(), a.surface()}, tolerance);
            swapped_apart += other.bounds.lower > h->upper || other.bounds.upper < h->lower;
        }
        const Bounds published =
            solve("interval_subdivision", scene, 100, {{"depth", std::int64_t(5)}, {"pairs", std::string("pruned")}})
                .bounds;
        published_misses += published.lower > h->upper || published.upper < h->lower;
        if (done % 10 == 5) {
            const Bounds bridge = solve("surface_meshes", scene, 1e-3, {{"cells", std::int64_t(24)}}).bounds;
            closed += bridge.gap() < 1;
            EXPECT_LE(bridge.lower, std::min(h->upper, result.bounds.upper)) << where;
            EXPECT_GE(bridge.upper, std::max(h->lower, result.bounds.lower)) << where;
        }
    }
    fmt::print(
        "{} pairs; left out: {} empty in their box, {} not decided. Reference within {}: {}. Converged: {}. Other "
        "direction told apart: {} of {}. "
        "Published interval refuted: {}. Bridge within 1: {} of {}.\n",
        done, empty, unknown, precision, sharp, converged, swapped_apart, pairs / 10, published_misses, closed,
        pairs / 10);
    fmt::print("Boxes split: {}, queued: {}\n", work.subdivisions, work.queue_pushes);
    for (const auto& [kind, count] : kinds) fmt::print("  {} {}\n", count, kind);
    EXPECT_EQ(kinds.size(), 11u);
    EXPECT_LE(unknown, 5);
    EXPECT_GE(sharp, pairs * 9 / 10);
    EXPECT_EQ(converged, pairs);
    EXPECT_GE(empty, 1);
    EXPECT_GE(swapped_apart, pairs / 20);
    EXPECT_GE(closed, pairs / 20);
    if (whole_searches()) {
        EXPECT_GE(published_misses, 1);  // shows that the published solver is not certified
    }
}

}  // namespace
}  // namespace hausbench
