// What solvers of meshes have in common: the shapes they take, a tree over B, the vertices of A in their pose, and the size of
// the coordinates, which decides how far rounding may go.
#pragma once

#include "kernel/rounding.h"
#include "solver.h"
#include "subdivision.h"
#include "target.h"

#include <algorithm>
#include <utility>

namespace hausbench {

// One query: A, its vertices in their pose, B, and M of kernel/rounding.h. All but the last are references.
struct MeshPair {
    const TriangleMesh& source;
    const Points& points;
    const Target& target;
    double magnitude;
};

// `Tree`: what a solver has over B, unless B is so small that a scan is as fast. A solver that needs more overrides needs() and
// prepare(), and calls these.
template <class Tree> class MeshSolver : public Solver {
public:
    Needs needs(const Scene& scene, const QuerySet&) const override {
        if (element_count(scene.target) <= scan_at_most) return {};
        return {need<Tree>(Side::target)};
    }

    void prepare(const Scene&, const Prepared& prepared) override {
        source_ = &prepared.triangles(Side::source);
        target_ = &prepared.triangles(Side::target);
        tree_ = prepared.has<Tree>(Side::target) ? &prepared.get<Tree>(Side::target) : nullptr;
    }

    Result solve(const Query& query, State* state, Trace& trace) const final {
        const Points points = posed(source_->vertices, query.source_pose);
        const double most = std::max(magnitude(points), magnitude(target_->vertices));
        if (!(most == 0 || (most >= smallest_safe_magnitude && most <= largest_safe_magnitude))) return {};
        const Target target(*target_, tree_, textbook_);
        return search({*source_, points, target, most}, query, state, trace);
    }

protected:
    explicit MeshSolver(bool textbook = false) : textbook_(textbook) {}

    const TriangleMesh& source() const { return *source_; }
    const Tree* tree() const { return tree_; }  // null: B is scanned

private:
    virtual Result search(const MeshPair& pair, const Query& query, State* state, Trace& trace) const = 0;

    bool textbook_;  // as Target takes it
    const TriangleMesh* source_ = nullptr;
    const TriangleMesh* target_ = nullptr;
    const Tree* tree_ = nullptr;
};

// Meshes or points on either side, certified, with a trace and fields. The rest is the solver's.
template <class Tree> SolverInfo mesh_solver_info(std::string name, std::string title, std::string paper) {
    SolverInfo info;
    info.name = std::move(name);
    info.title = std::move(title);
    info.paper = std::move(paper);
    info.source.mesh = info.source.points = info.target.mesh = info.target.points = true;
    info.certified = true;
    info.traces = true;
    info.fields = true;
    info.may_need = {need<Tree>(Side::target)};
    return info;
}

// The parameter `split` where the published one is at midpoints.
inline ParameterSpec split_parameter() {
    return {.name = "split",
            .default_value = std::string("midpoint"),
            .unit = "",
            .paper_value = "midpoint",
            .description =
                "how a piece of A is cut: four pieces at the midpoints of its edges, or two at that of the "
                "longest edge, for needles",
            .choices = {"midpoint", "longest_edge"}};
}

inline Split split_of(const Options& options) {
    return options.text("split") == "longest_edge" ? Split::longest_edge : Split::midpoint;
}

}  // namespace hausbench
