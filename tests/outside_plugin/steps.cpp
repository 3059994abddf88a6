// A sampler. Lower bound: the largest distance of a vertex of A. Upper bound: that plus `share` times
// A's longest edge. Points of a triangle are up to 1/sqrt(3) of its longest edge away from the nearest
// corner, so with a smaller share the upper bound is wrong on some scenes.
#include <hausbench/plugin.h>

#include <cmath>

using namespace hausbench;

SolverEntry vertex_only_solver();  // vertex_only.cpp

namespace {

class Steps final : public Solver {
public:
    explicit Steps(const Options& options)
        : share_(options.real("share")), good_(vertex_only_solver().make(Options("vertex_only", {}, {}))) {}

    void prepare(const Scene& scene, const Prepared& prepared) override {
        good_->prepare(scene, prepared);
        const Shape& source = scene.source;
        const auto& mesh = std::get<TriangleMesh>(source);
        for (Index i = 0; i < mesh.triangles.rows(); ++i) {
            for (int k = 0; k < 3; ++k) {
                const Vec3 edge =
                    mesh.vertices.row(mesh.triangles(i, k)) - mesh.vertices.row(mesh.triangles(i, (k + 1) % 3));
                longest_ = std::max(longest_, edge.norm());
            }
        }
    }

    Result solve(const Query& query, State*, Trace& trace) const override {
        Result result = good_->solve(query, nullptr, trace);
        result.bounds.upper = std::min(result.bounds.upper, result.bounds.lower + share_ * longest_);
        const bool close = result.bounds.gap() <= query.tolerance.gap(result.bounds.lower);
        result.status = close ? Status::converged : Status::budget;
        return result;
    }

private:
    double share_, longest_ = 0;
    std::unique_ptr<Solver> good_;
};

}  // namespace

SolverEntry steps_solver() {
    SolverInfo info = vertex_only_solver().info;
    info.name = "steps";
    info.title = "Samples at the vertices";
    info.source = info.target = {.mesh = true};
    info.abilities.erase(Ability::fields);
    info.abilities.erase(Ability::certificates);
    info.parameters = {{.name = "share",
                        .default_value = 0.025,
                        .unit = "longest edges of A",
                        .paper_value = "",
                        .description = "how far a point of A may be from a vertex, as is said"}};
    return {info, [](const Options& options) -> std::unique_ptr<Solver> { return std::make_unique<Steps>(options); }};
}
