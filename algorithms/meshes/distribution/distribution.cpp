// Statistics of the distance between two shapes, such as its mean, with certified bounds (ours; distribution.md).
//
// Cuts A, B or both into pieces with affine bounds on the distance, until the bounds of all statistics are within the
// tolerance. O(n + p) memory for p pieces; the number of pieces depends on the shapes and the tolerance. The unit of
// Query::budget is one piece.
#include "algorithms/kernel/rounding.h"
#include "algorithms/meshes/distribution/narrow.h"
#include "algorithms/solver.h"
#include "algorithms/structures/triangle_blocks.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

namespace hausbench::distribution {
namespace {

// A point set with the vertices of a mesh: a triangle (i, i, i) for each vertex that belongs to a triangle.
Triangles vertices_of(const TriangleMesh& mesh) {
    std::vector<bool> used(static_cast<std::size_t>(mesh.vertices.rows()));
    for (const Index i : mesh.triangles.reshaped()) used[static_cast<std::size_t>(i)] = true;
    Triangles all(std::count(used.begin(), used.end(), true), 3);
    Eigen::Index row = 0;
    for (std::size_t i = 0; i < used.size(); ++i)
        if (used[i]) all.row(row++).setConstant(static_cast<Index>(i));
    return all;
}

class Distribution final : public Solver {
public:
    explicit Distribution(const Options&) {}

    Needs needs(const Scene&, const QuerySet& queries) const override {
        Needs needs{need<TriangleBlocks>(Side::target)};
        if (queries.both_ways && !queries.moves) needs.push_back(need<TriangleBlocks>(Side::source));
        return needs;
    }

    void prepare(const Scene& scene, const Prepared& prepared) override {
        source_ = &prepared.triangles(Side::source);
        target_ = &prepared.triangles(Side::target);
        of_target_ = &prepared.get<TriangleBlocks>(Side::target);
        of_source_ = prepared.has<TriangleBlocks>(Side::source) ? &prepared.get<TriangleBlocks>(Side::source) : nullptr;
        counted_by_ = {counted_by(scene.source), counted_by(scene.target)};
    }

    Result solve(const Query& query, State*, Trace& trace) const override {
        const auto begin = std::chrono::steady_clock::now();
        Result result;
        for (const Statistic& statistic : query.statistics)
            result.statistics.push_back(is_share(statistic) ? Bounds{0, 1} : Bounds{});
        const Points points = posed(source_->vertices, query.source_pose);
        const double most = std::max(magnitude(points), magnitude(target_->vertices));
        // Outside this range the rounding errors are not bounded.
        if (!(most == 0 || (most >= smallest_safe_magnitude && most <= largest_safe_magnitude))) return result;
        const bool there = std::any_of(query.statistics.begin(), query.statistics.end(), needs_source);
        const bool back = std::any_of(query.statistics.begin(), query.statistics.end(), needs_target);
        const bool number = query.weigh == WeighBy::number;
        const CountedBy by_a = number ? CountedBy::points : counted_by_.first;
        const CountedBy by_b = number ? CountedBy::points : counted_by_.second;
        const auto pieces_of = [&](const TriangleMesh& mesh, CountedBy by) {
            return number                    ? vertices_of(mesh)
                   : by == CountedBy::length ? both_orders(mesh.triangles, mesh.vertices)
                                             : mesh.triangles;
        };
        const Triangles of_a = pieces_of(*source_, by_a);
        const Triangles of_b = back ? pieces_of(*target_, by_b) : Triangles();
        // B is compared with A as it is posed.
        std::optional<TriangleMesh> moved;
        std::optional<TriangleBlocks> of_moved;
        if (back && (!of_source_ || !query.source_pose.is_identity())) {
            moved.emplace(*source_);
            moved->vertices = points;
            of_moved.emplace(*moved);
        }
        const OneWay from_a{of_a, points, *of_target_, by_a};
        std::optional<OneWay> from_b;
        if (back) from_b.emplace(OneWay{of_b, target_->vertices, of_moved ? *of_moved : *of_source_, by_b});
        Query left = query;
        left.time_limit -= std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        const Narrowed narrowed = narrow(there ? &from_a : nullptr, back ? &*from_b : nullptr, most, left, trace);
        result.status = narrowed.status;
        result.note = narrowed.note;
        result.statistics = narrowed.bounds;
        result.counters = narrowed.counters;
        result.witness = narrowed.witness;
        // Vertices that count once each have numbers of their own.
        if (number && counted_by_.first != CountedBy::points) result.witness.source_element = -1;
        if (number && counted_by_.second != CountedBy::points) result.witness.target_element = -1;
        // both_orders() numbers the second order of all segments behind the first.
        if (by_a == CountedBy::length && result.witness.source_element >= source_->triangles.rows())
            result.witness.source_element -= static_cast<Index>(source_->triangles.rows());
        if (by_b == CountedBy::length && result.witness.target_element >= target_->triangles.rows())
            result.witness.target_element -= static_cast<Index>(target_->triangles.rows());
        result.reported["pieces"] = static_cast<double>(narrowed.pieces);
        return result;
    }

private:
    const TriangleMesh* source_ = nullptr;
    const TriangleMesh* target_ = nullptr;
    const TriangleBlocks* of_target_ = nullptr;
    const TriangleBlocks* of_source_ = nullptr;   // null if no query asks for the distances from B to A, or if A moves
    std::pair<CountedBy, CountedBy> counted_by_;  // what the parts of A and B count by, unless vertices count
};

}  // namespace

SolverEntry solver() {
    SolverInfo info;
    info.name = "distribution";
    info.title = "distribution (ours)";
    info.source.mesh = info.source.points = info.target.mesh = info.target.points = true;
    info.certified = true;
    info.quantities = {Quantity::distribution};
    info.abilities = {Ability::threads};
    info.may_need = {need<TriangleBlocks>(Side::target), need<TriangleBlocks>(Side::source)};
    return {info, make_solver<Distribution>};
}

}  // namespace hausbench::distribution
