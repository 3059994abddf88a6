// Every solver that traces must record samples before its answer, with bounds that hold.
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/quick_options.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"

#include <algorithm>
#include <set>

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

}  // namespace
}  // namespace hausbench
