// Work counters on small scenes, exactly as committed in counters_baseline.toml: they are the same on every machine,
// compiler and instruction set, so that any change is a change of the algorithm.
//
// Where a change is meant: HAUSBENCH_BASELINE_REASON='why the counters change' build/release/tests/counters_test
// writes the file anew; commit it together with the change.
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "algorithms/structures/bvh.h"
#include "algorithms/structures/octree.h"
#include "tests/support/scenes.h"
#include "tests/support/tree_meshes.h"

#include <cstdlib>
#include <fstream>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <toml++/toml.h>

namespace hausbench {
namespace {

constexpr const char* file = HAUSBENCH_BASELINE;

using Counts = std::map<std::string, Counters>;

Counts solver_counts(const std::string& name, const ParameterMap& given = {}) {
    const SolverEntry& entry = find_solver(name);
    std::vector<TestScene> scenes = mesh_scenes();
    scenes.push_back(test_scene("large sheets", sheet(24, 0.05, 0.2), sheet(40, 0, 0.1)));
    scenes.push_back(test_scene("fine on coarse", sheet(40, 0, 0.1), sheet(12, 0.05, 0.2)));
    Counts counts;
    for (const TestScene& test : scenes) {
        if (test.name.find("scale") != std::string::npos) continue;  // the same counts as unscaled
        const Session session(entry, Options(name, entry.info.parameters, given), test.scene, {});
        Query query;
        query.tolerance = {Tolerance::Of::absolute, 1e-5 * magnitude(points_of(test.scene.source)) + 1e-12};
        Trace trace;
        counts[test.name] = session.solve(query, trace).counters;
    }
    return counts;
}

Counts surface_counts(const std::string& name, const ParameterMap& given = {}) {
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

// Pairs of point sets: clouds that overlap, that lie apart, that nearly coincide, and what is hard for grids and trees.
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

Counts point_solver_counts(const std::string& name, const ParameterMap& given = {}) {
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

// The scan that every tree must equal, and that certifies witnesses of small targets.
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

std::map<std::string, Counts> all_counts() {
    std::map<std::string, Counts> all;
    all["cover"] = solver_counts("cover");
    all["guthe"] = solver_counts("guthe");
    all["guthe_longest_edge"] = solver_counts("guthe", {{"split", std::string("longest_edge")}});
    all["guthe_textbook"] = solver_counts("guthe", {{"kernel", std::string("textbook")}});
    all["sampling"] = solver_counts("sampling", {{"step", 0.02}});
    for (const char* name : {"tang", "kang", "zheng", "sacht"}) all[name] = solver_counts(name);
    all["tang_boxes"] = solver_counts("tang", {{"volumes", std::string("boxes")}, {"split", std::string("midpoint")}});
    all["tang_without_group"] = solver_counts("tang", {{"group", false}});
    all["closest_by_scan"] = scan_counts();
    all["bvh"] = tree_counts<TriangleBvh>();
    all["octree"] = tree_counts<TriangleOctree>();
    for (const char* name :
         {"naive", "earlybreak", "inc", "nohd", "nohd_as_printed", "ohd", "ohd_as_printed", "adaptive", "scan"})
        all[name] = point_solver_counts(name);
    all["nohd_without_early_break"] = point_solver_counts("nohd", {{"early_break", false}});
    all["ohd_without_culling"] = point_solver_counts("ohd", {{"culling", std::string("none")}});
    all["scan_by_tree"] =
        point_solver_counts("scan", {{"cells_from", std::int64_t{1'000'000'000'000}}, {"tree_from", std::int64_t{0}}});
    all["scan_by_cells"] = point_solver_counts("scan", {{"cells_from", std::int64_t{0}}});
    all["surface_enclosure"] = surface_counts("surface_enclosure");
    all["surface_meshes"] = surface_counts("surface_meshes", {{"cells", std::int64_t(12)}});
    all["interval_subdivision"] = surface_counts("interval_subdivision", {{"depth", std::int64_t(4)}});
    return all;
}

void write(const std::map<std::string, Counts>& all, const std::string& reason) {
    std::ofstream out(file);
    out << "# Written by tests/algorithms/counters_test.cpp, which says how to write it anew.\n";
    out << "reason = \"" << reason << "\"\n";
    for (const auto& [group, counts] : all) {
        out << "\n[" << group << "]\n";
        for (const auto& [name, counters] : counts) {
            std::string fields;
            for (const CounterField& field : counter_fields) {
                const std::uint64_t value = counters.*field.member;
                if (value != 0) fields += fmt::format("{}{} = {}", fields.empty() ? "" : ", ", field.name, value);
            }
            out << fmt::format("\"{}\" = {{ {} }}\n", name, fields);
        }
    }
}

std::set<std::string> keys(const toml::table& table) {
    std::set<std::string> all;
    for (const auto& [key, value] : table) {
        if (value.is_table()) all.emplace(key.str());
    }
    return all;
}

template <class Map> std::set<std::string> keys(const Map& map) {
    std::set<std::string> all;
    for (const auto& [key, value] : map) all.insert(key);
    return all;
}

// Solvers without a baseline, and why.
const std::map<std::string, std::string> without_baseline = {
    {"cgal", "CGAL counts nothing"},
    {"cgal_kdtree", "CGAL counts nothing; what is counted follows from |A| and |B|"},
    {"kdtree", "its count depends on the version of nanoflann"},
    {"penetration", "its counts are of another solver, on what the version of CGAL cuts"},
};

TEST(Counters, EverySolverHasABaselineOrAReasonForNone) {
    const auto baseline = keys(toml::parse_file(file));
    for (const SolverEntry& entry : solvers()) {
        const std::string& name = entry.info.name;
        EXPECT_NE(baseline.contains(name), without_baseline.contains(name))
            << name << " must be either in " << file << " or in the list of solvers without a baseline";
    }
}

TEST(Counters, AreThoseOfTheBaseline) {
    const auto all = all_counts();
    if (const char* reason = std::getenv("HAUSBENCH_BASELINE_REASON")) {
        ASSERT_GT(std::string(reason).size(), 10u) << "HAUSBENCH_BASELINE_REASON must say why the counters change";
        write(all, reason);
        GTEST_SKIP() << file << " is written anew; what was just written proves nothing";
    }
    const toml::table baseline = toml::parse_file(file);
    ASSERT_EQ(keys(baseline), keys(all)) << file;
    for (const auto& [group, counts] : all) {
        const toml::table& expected = *baseline[group].as_table();
        ASSERT_EQ(keys(expected), keys(counts)) << group;
        for (const auto& [name, counters] : counts) {
            EXPECT_NE(counters, Counters{}) << group << ", " << name << ": counts nothing";
            for (const CounterField& field : counter_fields) {
                const std::int64_t value = expected[name][field.name].value_or(std::int64_t{0});
                EXPECT_EQ(static_cast<std::int64_t>(counters.*field.member), value)
                    << group << ", " << name << ": " << field.name << ". If the change is meant, run\n  "
                    << "HAUSBENCH_BASELINE_REASON='why' build/release/tests/counters_test\n"
                    << "and commit tests/algorithms/counters_baseline.toml with it.";
            }
        }
    }
}

}  // namespace
}  // namespace hausbench
