// The counted work of `scan` on the hostile point sets of experiments/points/points_hostile.toml (20,000 points each)
// must stay near its work on an ordinary pair. Counts are the same on every machine.
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "datasets/catalogue.h"
#include "datasets/shape_file.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <toml++/toml.h>

namespace hausbench {
namespace {

Result answer(const std::string& solver, const Scene& scene, const ParameterMap& given = {}) {
    const SolverEntry& entry = find_solver(solver);
    const Session session(entry, Options(solver, entry.info.parameters, given), scene, {});
    Query query;
    query.tolerance.value = 1e-9;
    Trace trace;
    return session.solve(query, trace);
}

// Estimates the work: a tree node counts as eight distances, a bound test of a leaf as sixteen.
double work(const Counters& counters) {
    return static_cast<double>(counters.point_distances + 8 * counters.node_visits + 16 * counters.bound_tests);
}

class Hostile : public testing::Test {
protected:
    Points points(const std::string& name) const {
        const auto model = catalogue_.resolve(name);
        return points_of(read_shape(std::get<ResolvedModel>(model).shape_file).shape);
    }

    Scene scene(const std::string& source, const std::string& target) const {
        return {PointSet{points(source)}, PointSet{points(target)}};
    }

    TemporaryFolder folder_;
    const Catalogue catalogue_{HAUSBENCH_SOURCE "/datasets/manifest.toml", folder_.path(), ""};
};

TEST_F(Hostile, WorkIsAFewTimesThatOfATamePair) {
    catalogue_.make_folders();
    // Compares with the tree, which hostile sets need; cells would solve the ordinary pair in a fraction of this work.
    const double tame = work(answer("scan", scene("hostile_cloud_noise_20k", "hostile_cloud_b_20k"),
                                    {{"cells_from", std::int64_t{1000000000000000000}}})
                                 .counters);
    const toml::table experiment = toml::parse_file(HAUSBENCH_SOURCE "/experiments/points/points_hostile.toml");
    int scenes = 0;
    for (const toml::node& node : *experiment["scene"].as_array()) {
        const toml::table& table = *node.as_table();
        const std::string name = *table["name"].value<std::string>();
        if (!name.ends_with("_20K")) continue;
        const Result result =
            answer("scan", scene(*table["source"].value<std::string>(), *table["target"].value<std::string>()));
        EXPECT_EQ(to_string(result.status), to_string(Status::converged)) << name;
        EXPECT_LE(work(result.counters), 2 * tame) << name;
        std::cout << fmt::format("{}: {:.2f} times the work\n", name, work(result.counters) / tame);
        ++scenes;
    }
    EXPECT_EQ(scenes, 26);
}

}  // namespace
}  // namespace hausbench
