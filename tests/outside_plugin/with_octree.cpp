// A plug-in with the header of a structure that the program can share with its own solvers. Measures
// only the vertices of A.
#include <hausbench/plugin.h>
#include <hausbench/structures/octree.h>

#include <algorithm>
#include <cmath>

using namespace hausbench;

namespace {

class WithOctree final : public Solver {
public:
    explicit WithOctree(const Options&) {}

    Needs needs(const Scene&, const QuerySet&) const override { return {need<TriangleOctree>(Side::target)}; }

    void prepare(const Scene& scene, const Prepared& prepared) override {
        scene_ = &scene;
        octree_ = &prepared.get<TriangleOctree>(Side::target);
    }

    Result solve(const Query& query, State*, Trace&) const override {
        Result result;
        const Points a = posed(points_of(scene_->source), query.source_pose);
        for (Index i = 0; i < a.rows(); ++i) {
            const ClosestPoint nearest = octree_->closest(a.row(i), {}, result.counters);
            const double distance = std::sqrt(nearest.squared_distance) * (1 - 1e-12);
            if (distance <= result.bounds.lower) continue;
            result.bounds.lower = distance;
            result.witness = {a.row(i), nearest.point, -1, nearest.triangle};
        }
        result.status = Status::budget;
        return result;
    }

private:
    const Scene* scene_ = nullptr;
    const TriangleOctree* octree_ = nullptr;
};

SolverEntry with_octree() {
    SolverInfo info;
    info.name = info.title = "with_octree";
    info.source.mesh = info.target.mesh = true;
    info.may_need = {need<TriangleOctree>(Side::target)};
    return {info,
            [](const Options& options) -> std::unique_ptr<Solver> { return std::make_unique<WithOctree>(options); }};
}

}  // namespace

HAUSBENCH_PLUGIN(with_octree())
