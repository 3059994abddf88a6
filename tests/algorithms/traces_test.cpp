// Every solver that traces must record samples before its answer, with bounds that hold.
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/quick_options.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"

#include <algorithm>
#include <set>

#ifdef __SSE2__
#include <xmmintrin.h>
#endif

#include <gtest/gtest.h>

namespace hausbench {
namespace {

// Returns a pair of each kind of shape, on which no solver is done at its first bounds.
std::vector<Scene> scenes() {
    Random random(5);
    std::vector<Scene> all;
    all.push_back({surface_in_cube("x^2 + y^2 + z^2 - 1"), surface_in_cube("(x - 1/4)^2 + y^2 + z^2 - 1")});
    all.push_back({PointSet{cloud(random, 3000)}, PointSet{cloud(random, 3000)}});
    all.push_back({sheet(9, 0, 0.25), sheet(12, 0.3)});
    return all;
}

// Avoids the published search of interval_subdivision, which tries all pairs of voxels and is slow.
Options options(const SolverEntry& entry) {
    const bool pairs = entry.info.name == "interval_subdivision";
    return quick_options(entry, pairs ? ParameterMap{{"pairs", std::string("pruned")}} : ParameterMap{});
}

bool is_tried(const SolverInfo& info) {
    return info.can(Ability::traces) && info.offers(Quantity::directed) &&
           std::none_of(info.parameters.begin(), info.parameters.end(), [](const auto& p) { return p.required(); });
}

TEST(Traces, HoldSamplesBeforeTheLastWhoseBoundsHold) {
    std::set<std::string> tried;
    for (const Scene& scene : scenes()) {
        for (const SolverEntry& entry : solvers()) {
            if (!is_tried(entry.info)) continue;
            if (!refusal(entry.info, kind_of(scene.source), kind_of(scene.target)).empty()) continue;
            // Mesh solvers treat points as triangles without area, which they may solve at their first bounds.
            if (kind_of(scene.source) == ShapeKind::points && entry.info.source.mesh) continue;
            tried.insert(entry.info.name);
            Query query;
            query.tolerance = {Tolerance::Of::absolute, 1e-6};
            query.time_limit = 10;
            Trace trace(Trace::Mode::on);
            const Result result = Session(entry, options(entry), scene, {}).solve(query, trace);
            const std::vector<TraceSample>& samples = trace.samples();
            ASSERT_GE(samples.size(), 2u) << entry.info.name;
            double before = 0;
            for (const TraceSample& sample : samples) {
                EXPECT_GE(sample.seconds, before) << entry.info.name;
                EXPECT_LE(sample.lower, result.bounds.upper) << entry.info.name;
                EXPECT_GE(sample.upper, result.bounds.lower) << entry.info.name;
                before = sample.seconds;
            }
            EXPECT_EQ(samples.back().lower, result.bounds.lower) << entry.info.name;
            EXPECT_EQ(samples.back().upper, result.bounds.upper) << entry.info.name;
        }
    }
    for (const SolverEntry& entry : solvers())
        EXPECT_EQ(tried.contains(entry.info.name), is_tried(entry.info)) << entry.info.name;
}

Scene enlarged(Scene scene) {
    for (SharedShape* side : {&scene.source, &scene.target}) {
        Shape shape = *side;
        if (kind_of(shape) == ShapeKind::surface) continue;
        points_of(shape) *= 3e5;
        *side = std::move(shape);
    }
    return scene;
}

// The bounds shown to a watcher hold for the original query: in the unit of the input, at its poses, for h or H. Watching
// does not change a bit of the answer.
TEST(Traces, AreShownAsAnswersToTheQuery) {
    int shown_by = 0;
    for (const Scene& scene : scenes()) {
        const Scene large = enlarged(scene);
        const bool moves = kind_of(scene.source) != ShapeKind::surface;
        for (const SolverEntry& entry : solvers()) {
            if (!is_tried(entry.info)) continue;
            if (!refusal(entry.info, kind_of(scene.source), kind_of(scene.target)).empty()) continue;
            for (const bool symmetric : {false, true}) {
                QuerySet queries;
                queries.symmetric = symmetric;
                queries.target_moves = moves;
                const Session session(entry, options(entry), large, queries);
                Query query;
                query.quantity = symmetric ? Quantity::symmetric : Quantity::directed;
                query.tolerance = {Tolerance::Of::absolute, moves ? 0.1 : 1e-6};
                query.time_limit = 10;
                if (moves) query.target_pose.translation = {1e4, 0, 0};
                Trace unwatched, watched;
                std::vector<Bounds> seen;
                watched.watch([&](Result& so_far) {
                    EXPECT_EQ(so_far.status, Status::time_limit);
                    seen.push_back(so_far.bounds);
                });
                const Result plain = session.solve(query, unwatched), result = session.solve(query, watched);
                const std::string at = entry.info.name + (symmetric ? ", H" : ", h");
                EXPECT_EQ(plain.bounds.lower, result.bounds.lower) << at;
                EXPECT_EQ(plain.bounds.upper, result.bounds.upper) << at;
                for (const CounterField& field : counter_fields)
                    EXPECT_EQ(plain.counters.*field.member, result.counters.*field.member) << at;
                shown_by += !seen.empty();
                for (const Bounds& bounds : seen) {
                    EXPECT_LE(bounds.lower, result.bounds.upper) << at;
                    EXPECT_GE(bounds.upper, result.bounds.lower) << at;
                }
                if (symmetric && !entry.info.offers(Quantity::symmetric) && !seen.empty()) {
                    EXPECT_EQ(seen.front().upper, infinity) << at;  // h(B,A) has none yet
                }
            }
        }
    }
    EXPECT_GE(shown_by, 20);
}

#ifdef __SSE2__
// CGAL sets the rounding mode of SSE alone. A watcher and a hook are called with rounding to nearest, and the mode is kept.
TEST(Traces, ShowingKeepsTheRoundingModeOfSse) {
    volatile double one = 1, tiny = 0x1p-60;
    const auto to_nearest = [&] { return one + tiny == 1; };
    Trace trace;
    int nearest = 0;
    trace.watch([&](Result&) { nearest += to_nearest(); });
    const auto hook = [](void* data) { return (*static_cast<int*>(data))++; };
    int called = 0;
    const Interrupt interrupt(hook, &called);
    _MM_SET_ROUNDING_MODE(_MM_ROUND_UP);
    trace.show(1, 2);
    (void)interrupt.stop_requested();
    const bool kept = !to_nearest();
    _MM_SET_ROUNDING_MODE(_MM_ROUND_NEAREST);
    EXPECT_TRUE(kept);
    EXPECT_EQ(nearest, 1);
    EXPECT_EQ(called, 1);
}
#endif

}  // namespace
}  // namespace hausbench
