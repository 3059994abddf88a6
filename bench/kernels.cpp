// Benchmarks of single kernels, with Google Benchmark.
//
//   kernel_bench --meshes=torus:187,bunny,dragon [--benchmark_filter=closest ...]
//   kernel_bench --pairs=bunny:bunny_half,hand:hand_half --benchmark_filter=floor
//
// A mesh is torus:N (generated, with 2 * N^2 triangles) or a model of datasets/manifest.toml. With the suffix +R, as
// in bunny+1e6, one more triangle is added at a distance of R diagonals; the query points stay the same.
//
// In the output, `each` is the time of one item: a pair of a point and a triangle, a triangle or vertex of a
// structure that is built, or a query. `bytes` is the size of the structure. Do not compare two benchmarks of one run
// with each other, because the machine may have been disturbed during one of them. compare.cpp, which times its
// contenders in turn, is made for comparisons.
#include "algorithms/error.h"
#include "algorithms/kernel/textbook.h"
#include "algorithms/kernel/triangle_block.h"
#include "algorithms/meshes/tang/adjacency.h"
#include "algorithms/meshes/tang/swept_sphere.h"
#include "algorithms/points/inc/rtree.h"
#include "algorithms/points/scan/point_blocks.h"
#include "algorithms/points/zhang2017/point_octree.h"
#include "algorithms/structures/bvh.h"
#include "algorithms/structures/octree.h"
#include "algorithms/structures/triangle_blocks.h"
#include "algorithms/structures/triangle_grid.h"
#include "bench/machine.h"
#include "bench/models.h"
#include "datasets/random.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <memory>
#include <string_view>

namespace hausbench {
namespace {

using namespace tang;
using namespace inc;
using namespace scan;
using namespace zhang2017;

Vec3 random_vector(const RandomNumbers& random, std::uint64_t& next) {
    const double x = random.uniform(next++), y = random.uniform(next++), z = random.uniform(next++);
    return {2 * x - 1, 2 * y - 1, 2 * z - 1};
}

// --- one point and one triangle --------------------------------------------------------------------------------------

constexpr std::size_t pair_count = 4096;

// Point i belongs to triangle i. The blocks contain the same triangles in the same order.
struct Pairs {
    std::vector<Triangle> triangles;
    std::vector<Vec3> points;
    std::vector<TriangleBlock> blocks;
};

// Returns random triangles and points in the cube [-1, 1]^3. The points are about as far from the triangles as the
// triangles are large, so that the closest points include corners, points on edges and points inside.
const Pairs& random_pairs() {
    static const Pairs made = [] {
        Pairs all;
        const RandomNumbers random(7);
        std::uint64_t next = 0;
        TriangleMesh mesh{Points(3 * pair_count, 3), Triangles(pair_count, 3)};
        for (Index i = 0; i < static_cast<Index>(pair_count); ++i) {
            for (int k = 0; k < 3; ++k) {
                mesh.vertices.row(3 * i + k) = random_vector(random, next);
                mesh.triangles(i, k) = 3 * i + k;
            }
            all.triangles.push_back(triangle_of(mesh, i));
            all.points.push_back(random_vector(random, next));
        }
        for (Index i = 0; i < static_cast<Index>(pair_count); i += block_width) {
            Index lanes[block_width];
            for (Index k = 0; k < block_width; ++k) lanes[k] = i + k;
            all.blocks.emplace_back().set(mesh, lanes);
        }
        return all;
    }();
    return made;
}

template <class Kernel> void point_triangle(benchmark::State& state, const Kernel& kernel) {
    const Pairs& all = random_pairs();
    for (auto _ : state) {
        for (std::size_t i = 0; i < pair_count; ++i) benchmark::DoNotOptimize(kernel(all.points[i], all.triangles[i]));
    }
    count(state, pair_count);
}

// Times one point against all triangles of a block at once.
void point_block(benchmark::State& state) {
    const Pairs& all = random_pairs();
    BlockFeet feet;
    for (auto _ : state) {
        for (std::size_t i = 0; i < all.blocks.size(); ++i) {
            closest_points(all.points[i], all.blocks[i], feet);
            benchmark::DoNotOptimize(feet);
        }
    }
    count(state, pair_count);
}

void register_pairs() {
    using benchmark::RegisterBenchmark;
    RegisterBenchmark("point_triangle/scalar", [](auto& state) {
        point_triangle(state, [](const Vec3& p, const Triangle& t) { return closest_point(p, t); });
    });
    RegisterBenchmark("point_triangle/block", point_block);
    RegisterBenchmark("point_triangle/textbook", [](auto& state) {
        point_triangle(state, [](const Vec3& p, const Triangle& t) { return textbook_closest_point(p, t); });
    });
    RegisterBenchmark("point_triangle/certificate", [](auto& state) {
        point_triangle(state, [](const Vec3& p, const Triangle& t) {
            return distance_certainly_at_least(p, t, closest_point(p, t).point);
        });
    });
}

// --- structures ------------------------------------------------------------------------------------------------------

// A mesh, its query points and its trees. The query points are its vertices, each moved at random by up to 1 % of the
// diagonal along every axis. A tree is built when a benchmark first asks for it.
struct Subject {
    std::string name;
    TriangleMesh mesh;
    Points queries;
    std::unique_ptr<TriangleBvh> bvh;
    std::unique_ptr<TriangleOctree> octree;
    std::unique_ptr<SweptSphereBvh> swept;

    template <class Tree> const Tree& tree(std::unique_ptr<Tree>& place) {
        if (!place) place = std::make_unique<Tree>(mesh);
        return *place;
    }
    // Return the tree of the argument's type; the argument itself is not used.
    const TriangleBvh& get(const TriangleBvh*) { return tree(bvh); }
    const TriangleOctree& get(const TriangleOctree*) { return tree(octree); }
};

void add_stray_triangle(TriangleMesh& mesh, double diagonals) {
    const double size = diagonal(mesh.vertices);
    const Index vertices = static_cast<Index>(mesh.vertices.rows()),
                triangles = static_cast<Index>(mesh.triangles.rows());
    mesh.vertices.conservativeResize(vertices + 3, 3);
    mesh.triangles.conservativeResize(triangles + 1, 3);
    for (int k = 0; k < 3; ++k) {
        mesh.vertices.row(vertices + k) = size * (diagonals * Vec3(0.6, 0, 0.8) + 0.01 * Vec3::Unit(k));
        mesh.triangles(triangles, k) = vertices + k;
    }
}

std::unique_ptr<Subject> subject(const std::string& name) {
    auto made = std::make_unique<Subject>();
    made->name = name;
    const std::size_t plus = std::min(name.find('+'), name.size());
    const std::string model = name.substr(0, plus);
    made->mesh =
        model.starts_with("torus:") ? bumpy_torus(std::max(4, std::atoi(model.c_str() + 6))) : model_mesh(model);
    made->queries = made->mesh.vertices;
    const RandomNumbers random(8);
    std::uint64_t next = 0;
    const double size = 0.01 * diagonal(made->queries);
    for (Index i = 0; i < made->queries.rows(); ++i) made->queries.row(i) += size * random_vector(random, next);
    if (plus < name.size()) add_stray_triangle(made->mesh, std::atof(name.c_str() + plus + 1));
    return made;
}

// Not inlined, because `hausbench track` counts the instructions of the function with this name (bench/tracking).
template <class Built, class Input> [[gnu::noinline]] std::unique_ptr<Built> make_structure(const Input& input) {
    return std::make_unique<Built>(input);
}

template <class Built, class Input> void build(benchmark::State& state, const Input& input, std::size_t items) {
    for (auto _ : state) {
        auto built = make_structure<Built>(input);
        benchmark::DoNotOptimize(built);
        state.PauseTiming();
        state.counters["bytes"] = static_cast<double>(built->bytes());
        built.reset();
        state.ResumeTiming();
    }
    count(state, items);
}

// The kinds of closest-point queries. `cold` has no hints. `warm` first tests the closest triangle of the previous
// query. `radius` considers only triangles up to 1 % of the diagonal away; `enough` stops at the first triangle within
// that distance. `certified` asks for a lower bound on the exact distance; `textbook` uses textbook_closest_point().
enum class Ask { cold, warm, radius, enough, certified, textbook };

template <class Tree> void closest(benchmark::State& state, Subject& subject, Ask ask) {
    const Tree& tree = subject.get(static_cast<const Tree*>(nullptr));
    const double near = 0.01 * diagonal(subject.queries);
    Counters counters;
    ClosestHints hints;
    if (ask == Ask::radius) hints.squared_radius = near * near;
    if (ask == Ask::enough) hints.early_out_squared = near * near;
    for (auto _ : state) {
        for (Index i = 0; i < subject.queries.rows(); ++i) {
            const Vec3 point = subject.queries.row(i);
            if (ask == Ask::certified) {
                benchmark::DoNotOptimize(tree.certified_distance(point, counters));
                continue;
            }
            // Not const: DoNotOptimize() of constants is deprecated.
            ClosestPoint nearest = ask == Ask::textbook ? tree.textbook_closest(point, hints, counters)
                                                        : tree.closest(point, hints, counters);
            benchmark::DoNotOptimize(nearest);
            if (ask == Ask::warm) hints.warm_triangle = nearest.triangle;
        }
    }
    const auto queries = static_cast<std::size_t>(subject.queries.rows());
    count(state, queries);
    for (const CounterField& field : counter_fields) {  // per query
        const std::uint64_t value = counters.*field.member;
        if (value == 0 || field.member == &Counters::closest_point_queries) continue;
        state.counters[std::string(field.name)] =
            static_cast<double>(value) / static_cast<double>(state.iterations() * static_cast<std::int64_t>(queries));
    }
}

// Times queries without hints, for a structure that Subject does not keep. Building the structure is not timed.
template <class Built> void closest_cold(benchmark::State& state, const Subject& subject) {
    const Built built(subject.mesh);
    Counters counters;
    for (auto _ : state) {
        for (Index i = 0; i < subject.queries.rows(); ++i)
            benchmark::DoNotOptimize(built.closest(subject.queries.row(i), {}, counters));
    }
    count(state, static_cast<std::size_t>(subject.queries.rows()));
}

// Times the lower and the upper bound on the distance from one point to a swept sphere volume. Takes the first volume
// of each node, for up to 4096 nodes.
void swept_bounds(benchmark::State& state, Subject& subject) {
    const SweptSphereBvh& tree = subject.tree(subject.swept);
    const Vec3 point = subject.queries.row(0);
    const std::size_t nodes = std::min<std::size_t>(tree.tree().nodes.size(), 4096);
    for (auto _ : state) {
        for (std::size_t n = 0; n < nodes; ++n) {
            benchmark::DoNotOptimize(distance_at_least(tree.volume(n, 0), point));
            benchmark::DoNotOptimize(distance_at_most(tree.volume(n, 0), point));
        }
    }
    count(state, nodes);
}

void register_subject(Subject& s) {
    const auto triangles = static_cast<std::size_t>(s.mesh.triangles.rows()),
               vertices = static_cast<std::size_t>(s.mesh.vertices.rows());
    const auto add = [&](const std::string& name, auto&& f) {
        benchmark::RegisterBenchmark((name + "/" + s.name).c_str(), f)->Unit(benchmark::kMillisecond);
    };
    add("build/bvh", [&s, triangles](auto& state) { build<TriangleBvh>(state, s.mesh, triangles); });
    add("build/octree", [&s, triangles](auto& state) { build<TriangleOctree>(state, s.mesh, triangles); });
    constexpr std::pair<const char*, Ask> asks[] = {{"cold", Ask::cold},           {"warm", Ask::warm},
                                                    {"radius", Ask::radius},       {"enough", Ask::enough},
                                                    {"certified", Ask::certified}, {"textbook", Ask::textbook}};
    for (const auto& [name, ask] : asks) {
        add(fmt::format("closest/bvh/{}", name), [&s, how = ask](auto& state) { closest<TriangleBvh>(state, s, how); });
        add(fmt::format("closest/octree/{}", name),
            [&s, how = ask](auto& state) { closest<TriangleOctree>(state, s, how); });
    }
    if (s.name.find('+') != std::string::npos) return;  // the added triangle is a test of the BVH and the octree only
    add("build/swept_bvh", [&s, triangles](auto& state) { build<SweptSphereBvh>(state, s.mesh, triangles); });
    add("build/triangle_blocks", [&s, triangles](auto& state) { build<TriangleBlocks>(state, s.mesh, triangles); });
    add("build/triangle_grid", [&s, triangles](auto& state) { build<TriangleGrid>(state, s.mesh, triangles); });
    add("closest/triangle_blocks/cold", [&s](auto& state) { closest_cold<TriangleBlocks>(state, s); });
    add("closest/triangle_grid/cold", [&s](auto& state) { closest_cold<TriangleGrid>(state, s); });
    add("build/adjacency", [&s, triangles](auto& state) { build<Adjacency>(state, s.mesh, triangles); });
    add("build/point_octree", [&s, vertices](auto& state) { build<PointOctree>(state, s.mesh.vertices, vertices); });
    add("build/point_blocks", [&s, vertices](auto& state) { build<PointBlocks>(state, s.mesh.vertices, vertices); });
    add("build/rtree", [&s, vertices](auto& state) { build<RTree>(state, s.mesh.vertices, vertices); });
    add("bounds/swept_sphere", [&s](auto& state) { swept_bounds(state, s); });
}

// --- pairs of meshes ---------------------------------------------------------------------------------------------------

struct PairOfMeshes {
    TriangleMesh source, target;
    std::unique_ptr<TriangleBlocks> blocks;  // of the target
};

// Times what any answer by groups takes at least: reading and sorting both meshes, and one query from each group of
// sixteen neighbouring triangles of A, which begins with the answer of the group before. The memory is warm.
void floor_of(benchmark::State& state, PairOfMeshes& pair) {
    if (!pair.blocks) pair.blocks = std::make_unique<TriangleBlocks>(pair.target);
    Counters counters;
    for (auto _ : state) {
        const TriangleOrder source(pair.source), target(pair.target);
        benchmark::DoNotOptimize(target.order.data());
        ClosestHints hints;
        for (std::size_t i = 0; i < source.order.size(); i += 16) {
            const Index vertex = pair.source.triangles(source.order[i], 0);
            hints.warm_triangle = pair.blocks->closest(pair.source.vertices.row(vertex), hints, counters).triangle;
        }
        benchmark::DoNotOptimize(hints.warm_triangle);
    }
    count(state, static_cast<std::size_t>(pair.source.triangles.rows() + pair.target.triangles.rows()));
}

// Calls use(name) for each name of a list with commas. Says which ones were left out, because a model was not fetched.
template <class Use> void each_of(const std::string& names, const Use& use) {
    for (std::size_t begin = 0; begin < names.size();) {
        const std::size_t end = std::min(names.find(',', begin), names.size());
        try {
            use(names.substr(begin, end - begin));
        } catch (const InputError& error) {
            fmt::print(stderr, "skipped: {}\n", error.what());
        }
        begin = end + 1;
    }
}

// Takes an option of this form off the command line, if it is the first one. Returns its value, or else `usual`.
std::string take_option(int& argc, char** argv, std::string_view option, const char* usual) {
    if (argc < 2 || !std::string_view(argv[1]).starts_with(option)) return usual;
    std::string value = argv[1] + option.size();
    std::copy(argv + 2, argv + argc, argv + 1);
    --argc;
    return value;
}

}  // namespace
}  // namespace hausbench

int main(int argc, char** argv) {
    using namespace hausbench;
    const std::string wanted_pairs = take_option(argc, argv, "--pairs=", "");
    const std::string meshes = take_option(argc, argv, "--meshes=", wanted_pairs.empty() ? "torus:187" : "");
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    register_machine();
    register_pairs();
    std::vector<std::unique_ptr<Subject>> subjects;
    each_of(meshes, [&](const std::string& name) {
        subjects.push_back(subject(name));
        register_subject(*subjects.back());
    });
    std::vector<std::unique_ptr<PairOfMeshes>> loaded;
    each_of(wanted_pairs, [&](const std::string& name) {
        const std::size_t colon = std::min(name.find(':'), name.size() - 1);
        PairOfMeshes pair{model_mesh(name.substr(0, colon)), model_mesh(name.substr(colon + 1)), nullptr};
        PairOfMeshes& kept = *loaded.emplace_back(std::make_unique<PairOfMeshes>(std::move(pair)));
        benchmark::RegisterBenchmark(("floor/" + name).c_str(), [&kept](auto& state) {
            floor_of(state, kept);
        })->Unit(benchmark::kMillisecond);
    });
    benchmark::RunSpecifiedBenchmarks();
}
