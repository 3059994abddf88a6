// A solver in one file: the corners of A against every triangle of B.
//
// Lower bound: the largest distance of a corner. Upper bound: adds L / sqrt(3), where L is the longest edge, because
// no point of a triangle is farther from its nearest corner. Ignores rounding errors, so it is not `certified`.
#include <hausbench/kernel/point_triangle.h>
#include <hausbench/plugin.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

using namespace hausbench;

class Corners final : public Solver {
public:
    explicit Corners(const Options&) {}

    void prepare(const Scene& scene, const Prepared&) override { scene_ = &scene; }

    Result solve(const Query& query, State*, Trace&) const override {
        const TriangleMesh &source = mesh_of(scene_->source), &target = mesh_of(scene_->target);
        const Points a = posed(source.vertices, query.source_pose);
        Result result;
        result.bounds = {0, 0};
        for (Index t = 0; t < source.triangles.rows(); ++t) {
            std::array<Vec3, 3> corners;
            for (int k = 0; k < 3; ++k) corners[k] = a.row(source.triangles(t, k));
            double farthest = 0, longest = 0;
            for (int k = 0; k < 3; ++k) {
                longest = std::max(longest, (corners[k] - corners[(k + 1) % 3]).norm());
                const auto [distance, near] = nearest(corners[k], target);
                farthest = std::max(farthest, distance);
                if (distance <= result.bounds.lower) continue;
                result.bounds.lower = distance;
                result.witness = {corners[k], near, t, -1};
            }
            result.bounds.upper = std::max(result.bounds.upper, farthest + longest / std::sqrt(3.0));
        }
        const bool close = result.bounds.gap() <= query.tolerance.gap(result.bounds.lower);
        result.status = close ? Status::converged : Status::budget;
        if (!close) result.note = "corners alone come no closer than this";
        return result;
    }

private:
    static std::pair<double, Vec3> nearest(const Vec3& p, const TriangleMesh& mesh) {
        std::pair<double, Vec3> best{std::numeric_limits<double>::infinity(), p};
        for (Index t = 0; t < mesh.triangles.rows(); ++t) {
            const auto corner = [&](int k) -> Vec3 { return mesh.vertices.row(mesh.triangles(t, k)); };
            const TrianglePoint q = closest_point(p, {corner(0), corner(1), corner(2)});
            if (q.squared_distance < best.first) best = {q.squared_distance, q.point};
        }
        return {std::sqrt(best.first), best.second};
    }

    const Scene* scene_ = nullptr;
};

SolverEntry corners_solver() {
    SolverInfo info;
    info.name = "corners";
    info.title = "Corners of A";
    info.source = info.target = {.mesh = true};
    return {info, [](const Options& options) -> std::unique_ptr<Solver> { return std::make_unique<Corners>(options); }};
}

HAUSBENCH_PLUGIN(corners_solver())
