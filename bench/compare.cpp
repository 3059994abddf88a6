// Compares our closest-point structures with Embree and CGAL, and the solver `guthe` with and without certified bounds.
//
// The contenders of a comparison run in turn within one process (interleave.h), so the ratios of their times are
// reliable even if the speed of the machine varies. Writes CSV to standard output and progress to standard error;
// bench/report.py makes the table.
#include "algorithms/error.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "bench/closest_rival.h"
#include "bench/interleave.h"
#include "bench/models.h"
#include "harness/result/provenance.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace hausbench {
namespace {

struct Row {
    std::string part, scene, contender;
    Index elements;             // triangles of the mesh (build), query points (query), or 1 (certification)
    double nanoseconds;         // per element, median over rounds
    Estimate ratio;             // time divided by the time of the first contender of this part and scene
    std::size_t bytes;          // 0: unknown
    double largest_difference;  // of a distance or bound from the first contender's, as a fraction of a diagonal
};

void print(const Row& row) {
    fmt::print("{},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{},{},{:.3g}\n", row.part, row.scene, row.contender,
               row.elements, row.nanoseconds, row.ratio.value, row.ratio.low, row.ratio.high, row.ratio.n, row.bytes,
               row.largest_difference);
    std::fflush(stdout);
}

using Rivals = std::vector<std::unique_ptr<ClosestRival>>;

Rivals rivals() {
    Rivals all;
    for (const auto& make : {bvh_rival, bvh_warm_rival, octree_rival, blocks_rival, embree_rival, cgal_rival}) {
        if (auto rival = make()) all.push_back(std::move(rival));
    }
    return all;
}

void compare_builds(const std::string& model, int rounds) {
    const TriangleMesh mesh = model_mesh(model);
    Rivals all = rivals();
    // Leaves out the warm start, which only changes queries and is built like "BVH".
    std::erase_if(all, [](const auto& rival) { return rival->name() == "BVH (warm start)"; });
    std::vector<Contender> contenders;
    std::vector<std::size_t> bytes(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        all[i]->take(mesh);
        contenders.push_back(
            {[] {}, [&, i] { all[i]->build(); }, [&, i] { bytes[i] = all[i]->bytes(), all[i]->forget(); }});
    }
    const auto seconds = interleave(contenders, rounds);
    const auto elements = static_cast<Index>(mesh.triangles.rows());
    for (std::size_t i = 0; i < all.size(); ++i) {
        print({"build", model, all[i]->name(), elements, 1e9 * median(seconds[i]).value / elements,
               paired_ratio(seconds[0], seconds[i]), bytes[i], 0});
    }
}

void compare_queries(const std::string& near, const std::string& model, int rounds) {
    const TriangleMesh mesh = model_mesh(model);
    const Points points = model_mesh(near).vertices;
    const Rivals all = rivals();
    std::vector<Contender> contenders;
    std::vector<std::vector<double>> distances(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        all[i]->take(mesh);
        all[i]->build();
        distances[i].resize(static_cast<std::size_t>(points.rows()));
        contenders.push_back({[] {}, [&, i] { all[i]->distances(points, distances[i]); }, [] {}});
    }
    const auto seconds = interleave(contenders, rounds);
    for (std::size_t i = 0; i < all.size(); ++i) {
        double largest = 0;
        for (std::size_t k = 0; k < distances[i].size(); ++k)
            largest = std::max(largest, std::abs(distances[i][k] - distances[0][k]));
        print({"query", near + " to " + model, all[i]->name(), static_cast<Index>(points.rows()),
               1e9 * median(seconds[i]).value / static_cast<double>(points.rows()),
               paired_ratio(seconds[0], seconds[i]), 0, largest / diagonal(mesh.vertices)});
    }
}

// Times `guthe` on a pair of meshes without and with certified bounds. Only solving is timed, because both variants
// prepare the meshes in the same way.
void compare_certification(const std::string& source, const std::string& target, int rounds) {
    const Scene scene{model_mesh(source), model_mesh(target)};
    const SolverEntry& guthe = find_solver("guthe");
    Query query;
    query.tolerance = {Tolerance::Of::absolute, 1e-6 * diagonal(points_of(scene.source))};
    std::vector<std::unique_ptr<Session>> sessions;
    std::vector<Contender> contenders;
    std::vector<double> lower(2);
    for (const bool certify : {false, true}) {
        const Options options("guthe", guthe.info.parameters, {{"certify", certify}});
        sessions.push_back(std::make_unique<Session>(guthe, options, scene, QuerySet{}));
        const auto solve = [&, session = sessions.back().get(), certify] {
            Trace untraced;
            const Result result = session->solve(query, untraced);
            if (result.status != Status::converged) throw InputError(source + " to " + target + ": did not converge");
            lower[certify ? 1 : 0] = result.bounds.lower;
        };
        contenders.push_back({[] {}, solve, [] {}});
    }
    const auto seconds = interleave(contenders, rounds);
    for (std::size_t i = 0; i < 2; ++i) {
        print({"certification", source + " to " + target, i == 0 ? "guthe (not certified)" : "guthe (certified)", 1,
               1e9 * median(seconds[i]).value, paired_ratio(seconds[0], seconds[i]), 0,
               std::abs(lower[i] - lower[0]) / diagonal(points_of(scene.source))});
    }
}

// Runs the named parts, or all if `parts` is empty. Skips a comparison if a model was not fetched. Returns the number
// of comparisons that ran.
int run(int rounds, const std::vector<std::string>& parts) {
    const auto wants = [&](const char* part) {
        return parts.empty() || std::find(parts.begin(), parts.end(), part) != parts.end();
    };
    const Machine& machine = this_machine();
    fmt::print("# machine: {}, caches {}, {}\n# build: {}, {}; commit {}, changed since: {}; {}\n", machine.cpu,
               machine.caches, machine.system, this_build().compiler, this_build().flags, this_build().commit,
               this_build().dirty, utc_now());
    fmt::print("part,scene,contender,elements,nanoseconds,ratio,low,high,rounds,bytes,largest_difference\n");
    if (!embree_rival()) {
        fmt::print(
            stderr,
            "without Embree: sudo apt-get install --no-install-recommends libembree-dev, and make bench again\n");
    }
    if (!cgal_rival()) fmt::print(stderr, "without CGAL: this program was built with HAUSBENCH_WITH_CGAL_PEER=OFF\n");
    int made = 0;
    const auto attempt = [&](const std::string& what, const auto& f) {
        fmt::print(stderr, "{}\n", what);
        try {
            f();
            ++made;
        } catch (const InputError& error) {  // a model was not fetched
            fmt::print(stderr, "skipped: {}\n", error.what());
        }
    };
    if (wants("build")) {
        for (const char* model : {"bunny", "snowden_hi", "dragon_res2", "dragon"}) {
            attempt(fmt::format("build, {}", model), [&] { compare_builds(model, rounds); });
        }
    }
    struct Models {
        const char *a, *b;
    };
    const Models near[] = {{"bunny_half", "bunny"},
                           {"bunny_cgal_normalised", "bunny_normalised"},
                           {"snowden_lo", "snowden_hi"},
                           {"dragon", "dragon_res2"},
                           {"dragon_res2", "dragon"}};
    if (wants("query")) {
        for (const Models& m : near) {
            attempt(fmt::format("query, {} to {}", m.a, m.b), [&] { compare_queries(m.a, m.b, rounds); });
        }
    }
    const Models pairs[] = {{"bunny_half", "bunny"},
                            {"elephant", "refined_elephant"},
                            {"armadillo_half", "armadillo"},
                            {"bunny_cgal_normalised", "bunny_normalised"}};
    if (wants("certification")) {
        for (const Models& m : pairs) {
            attempt(fmt::format("certification, {} to {}", m.a, m.b), [&] { compare_certification(m.a, m.b, rounds); });
        }
    }
    return made;
}

}  // namespace
}  // namespace hausbench

int main(int argc, char** argv) {
    CLI::App app("Kernels of hausbench against Embree and CGAL, as ratios within one run; CSV on standard output");
    int rounds = 12;
    std::vector<std::string> parts;
    app.add_option("--rounds", rounds, "of each comparison; an interval of 95 % takes 6")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--part", parts, "build, query, certification; all of them if none is named")
        ->check(CLI::IsMember({"build", "query", "certification"}));
    CLI11_PARSE(app, argc, argv);
    try {
        if (hausbench::run(rounds, parts) == 0) {
            fmt::print(stderr, "nothing was measured: `make datasets` fetches the models\n");
            return 5;
        }
    } catch (const hausbench::InputError& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 2;
    }
}
