// Work counters on small scenes must equal those in bench/tracking/baseline.toml ([small_scenes]). They are the same on
// every machine, compiler and instruction set, so a difference means that the algorithm changed.
//
// `hausbench track --tiers counters --update 'why the counters change'` records them anew: it runs this program with
// HAUSBENCH_COUNTS set to the file to write. A new solver is not compared until it is recorded.
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "algorithms/structures/bvh.h"
#include "algorithms/structures/octree.h"
#include "tests/support/scenes.h"
#include "tests/support/tree_meshes.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <toml++/toml.h>

namespace hausbench {
namespace {

constexpr const char* file = HAUSBENCH_BASELINE;

using Counts = std::map<std::string, Counters>;

Counts mesh_solver_counts(const std::string& name, const ParameterMap& given) {
    const SolverEntry& entry = find_solver(name);
    std::vector<TestScene> scenes = mesh_scenes();
    scenes.push_back(test_scene("large sheets", sheet(24, 0.05, 0.2), sheet(40, 0, 0.1)));
    scenes.push_back(test_scene("fine on coarse", sheet(40, 0, 0.1), sheet(12, 0.05, 0.2)));
    Counts counts;
    for (const TestScene& test : scenes) {
        if (test.name.find("scale") != std::string::npos) continue;  // the same counts as unscaled
        const Session session(entry, Options(name, entry.info.parameters, given), test.scene, {});
        Query query;
        double tolerance = 1e-5;
        if (!entry.info.offers(Quantity::directed)) {
            query.quantity = Quantity::distribution;
            query.statistics = {{Statistic::Kind::mean}, {Statistic::Kind::quantile, 0.95}};
            tolerance = 1e-2;  // few random points are enough
        }
        query.tolerance = {Tolerance::Of::absolute, tolerance * magnitude(points_of(test.scene.source)) + 1e-12};
        Trace trace;
        counts[test.name] = session.solve(query, trace).counters;
    }
    return counts;
}

Counts surface_counts(const std::string& name, const ParameterMap& given) {
    const auto surface = [](const std::string& text) {
        AlgebraicSurface s{text, Points(2, 3)};
        s.box.row(0).setConstant(-2);
        s.box.row(1).setConstant(2);
        return s;
    };
    const AlgebraicSurface ball = surface("x^2 + y^2 + z^2 - 1"), large = surface("x^2 + y^2 + z^2 - 9/4"),
                           torus = surface("(x^2 + y^2 + z^2 + 3/4)^2 - 4*(x^2 + y^2)"),
                           cone = surface("x^2/4 + y^2/4 - z^2/9"), other = surface("x^2/16 + y^2/4 - z^2/9");
    const std::tuple<const char*, AlgebraicSurface, AlgebraicSurface> scenes[] = {
        {"cones", cone, other}, {"concentric spheres", ball, large}, {"torus to sphere", torus, ball}};
    const SolverEntry& entry = find_solver(name);
    Counts counts;
    for (const auto& [scene, a, b] : scenes) {
        const Session session(entry, Options(name, entry.info.parameters, given), {a, b}, {});
        Query query;
        query.tolerance = {Tolerance::Of::absolute, 1e-3};
        Trace trace;
        counts[scene] = session.solve(query, trace).counters;
    }
    return counts;
}

template <class Tree> Counts tree_counts() {
    Counts counts;
    for (const auto& [name, mesh] : tree_meshes()) {
        if (name.starts_with("random")) continue;
        const Tree tree(mesh);
        Random random(9);
        Counters& counters = counts[name];
        Index warm = -1;
        for (int i = 0; i < 200; ++i) {
            ClosestHints hints;
            if (i % 2 != 0) hints.warm_triangle = warm;
            warm = tree.closest(query_near(mesh, random), hints, counters).triangle;
        }
    }
    return counts;
}

// Makes pairs of point sets: overlapping, apart, nearly coincident, and hard for grids and trees.
std::vector<TestScene> point_scenes() {
    Random random(10);
    const auto noisy = [&](Points points, double size) {
        for (Index i = 0; i < points.rows(); ++i) points.row(i) += random.vector(size).transpose();
        return points;
    };
    const Points a = cloud(random, 500), b = cloud(random, 400), large = cloud(random, 3000);
    Points outlier(401, 3), line = b, few = b;
    outlier << b, Eigen::RowVector3d(1e4, 0, 0);
    for (Index j = 0; j < b.rows(); ++j)
        line.row(j) = b(j, 0) * Eigen::RowVector3d(1, 0.5, -0.25), few.row(j) = b.row(j % 7);
    std::vector<TestScene> scenes;
    const auto add = [&](const char* name, const Points& from, const Points& to) {
        scenes.push_back({name, {PointSet{from}, PointSet{to}}, {}});
    };
    add("clouds", a, b);
    add("clouds apart", a, Points(b.rowwise() + Eigen::RowVector3d(9, 0, 0)));
    add("the same", b, b);
    add("noise", noisy(b, 1e-3), b);
    add("noise, large", noisy(large, 1e-4), large);
    add("an outlier in B", noisy(b, 1e-3), outlier);
    add("lines", Points(line * 0.9), line);
    add("duplicates", noisy(few, 1e-3), few);
    add("one point", a.topRows(1), b);
    return scenes;
}

Counts point_solver_counts(const std::string& name, const ParameterMap& given) {
    const SolverEntry& entry = find_solver(name);
    Counts counts;
    for (const TestScene& test : point_scenes()) {
        const Session session(entry, Options(name, entry.info.parameters, given), test.scene, {});
        Query query;
        query.tolerance = {Tolerance::Of::absolute, 1e-9};
        Trace trace;
        counts[test.name] = session.solve(query, trace).counters;
    }
    return counts;
}

// Counts the work of plain scans over all triangles, which solvers use for small targets.
Counts scan_counts() {
    Counts counts;
    for (const auto& [name, mesh] : tree_meshes()) {
        if (name.starts_with("random") || mesh.triangles.rows() > 400) continue;
        Random random(9);
        for (int i = 0; i < 20; ++i) {
            const Vec3 query = query_near(mesh, random);
            (void)closest_by_scan(mesh, query, {}, counts[name]);
            (void)certified_distance_by_scan(mesh, query, counts[name]);
        }
    }
    return counts;
}

Counts solver_counts(const std::string& name, const ParameterMap& given = {}) {
    const ShapeSet source = find_solver(name).info.source;
    return (source.mesh ? mesh_solver_counts : source.surface ? surface_counts : point_solver_counts)(name, given);
}

// Solvers whose counts depend on the version of a library.
const std::set<std::string> not_counted = {"cgal", "cgal_kdtree", "kdtree", "penetration"};

using Groups = std::map<std::string, std::function<Counts()>>;

// Returns the groups of counters: each solver (with cheaper options if it is slow here), variants of solvers, and
// search structures.
Groups groups() {
    Groups all;
    const auto add = [&](const std::string& group, const std::string& solver, const ParameterMap& given = {}) {
        all[group] = [=] { return solver_counts(solver, given); };
    };
    for (const SolverEntry& entry : solvers()) {
        if (!not_counted.contains(entry.info.name)) add(entry.info.name, entry.info.name);
    }
    add("sampling", "sampling", {{"step", 0.02}});
    add("surface_meshes", "surface_meshes", {{"cells", std::int64_t(12)}});
    add("interval_subdivision", "interval_subdivision", {{"depth", std::int64_t(4)}});
    add("guthe_longest_edge", "guthe", {{"split", std::string("longest_edge")}});
    add("guthe_textbook", "guthe", {{"kernel", std::string("textbook")}});
    add("tang_boxes", "tang", {{"volumes", std::string("boxes")}, {"split", std::string("midpoint")}});
    add("tang_without_group", "tang", {{"group", false}});
    add("nohd_without_early_break", "nohd", {{"early_break", false}});
    add("ohd_without_culling", "ohd", {{"culling", std::string("none")}});
    add("scan_by_tree", "scan", {{"cells_from", std::int64_t{1'000'000'000'000}}, {"tree_from", std::int64_t{0}}});
    add("scan_by_cells", "scan", {{"cells_from", std::int64_t{0}}});
    all["closest_by_scan"] = scan_counts;
    all["bvh"] = tree_counts<TriangleBvh>;
    all["octree"] = tree_counts<TriangleOctree>;
    return all;
}

void write(const Groups& all, const char* to) {
    std::ofstream out(to);
    for (const auto& [group, count] : all) {
        const Counts counts = count();
        if (std::all_of(counts.begin(), counts.end(), [](const auto& entry) { return entry.second == Counters{}; }))
            continue;
        out << "[" << group << "]\n";
        for (const auto& [name, counters] : counts) {
            std::string fields;
            for (const CounterField& field : counter_fields) {
                const std::uint64_t value = counters.*field.member;
                if (value != 0) fields += fmt::format("{}{} = {}", fields.empty() ? "" : ", ", field.name, value);
            }
            out << fmt::format("\"{}\" = {{ {} }}\n", name, fields);
        }
    }
    ASSERT_TRUE(out.flush()) << to << " cannot be written";
}

std::set<std::string> keys(const toml::table& table) {
    std::set<std::string> all;
    for (const auto& [key, value] : table) all.emplace(key.str());
    return all;
}

std::set<std::string> keys(const Counts& counts) {
    std::set<std::string> all;
    for (const auto& [key, value] : counts) all.insert(key);
    return all;
}

TEST(Counters, AreThoseOfTheBaseline) {
    const Groups all = groups();
    if (const char* counts = std::getenv("HAUSBENCH_COUNTS")) {
        write(all, counts);
        GTEST_SKIP() << counts << " is written; nothing was compared";
    }
    const toml::table baseline = toml::parse_file(file);
    const toml::table& recorded = *baseline["small_scenes"].as_table();
    for (const auto& [group, count] : all) {
        if (!recorded.contains(group))
            std::cout << group << ": not recorded yet: hausbench track --tiers counters --update 'why'\n";
    }
    for (const auto& [key, scenes] : recorded) {
        const std::string group(key.str());
        const auto& gone = solvers_not_built();
        if (std::any_of(gone.begin(), gone.end(), [&](const NotBuilt& solver) { return solver.name == group; }))
            continue;
        ASSERT_TRUE(all.contains(group)) << file << ": remove [small_scenes." << group << "], which nothing counts";
        const Counts counts = all.at(group)();
        const toml::table& expected = *scenes.as_table();
        ASSERT_EQ(keys(expected), keys(counts)) << group;
        for (const auto& [name, counters] : counts) {
            for (const CounterField& field : counter_fields) {
                const std::int64_t value = expected[name][field.name].value_or(std::int64_t{0});
                EXPECT_EQ(static_cast<std::int64_t>(counters.*field.member), value)
                    << group << ", " << name << ": " << field.name << ". If the change is meant, run\n  "
                    << "hausbench track --tiers counters --update 'why'\nand commit " << file << " with it.";
            }
        }
    }
}

}  // namespace
}  // namespace hausbench
