// The base class of mesh solvers.
#pragma once

#include "algorithms/kernel/posed_box.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/search/cut_options.h"
#include "algorithms/search/target.h"
#include "algorithms/solver.h"
#include "algorithms/structures/bvh.h"

#include <algorithm>
#include <concepts>
#include <type_traits>
#include <utility>

namespace hausbench {

// The two meshes of one query, with A moved by its pose. Owns none of the data.
struct MeshPair {
    const TriangleMesh& source;       // A in its own coordinates
    const Points& points;             // the vertices of A, moved by its pose
    const Target& target;             // B
    double magnitude;                 // M of kernel/rounding.h: the largest |coordinate| of `points` and B
    const TriangleTree* source_tree;  // over A in its own coordinates; null if not used
};

// Returns the length of the diagonal of the box around both meshes, with A moved by its pose. O(n + m).
inline double diagonal_of(const MeshPair& pair) {
    Box box = box_of(pair.points);
    box.add(box_of(pair.target.mesh().vertices));
    return (box.high - box.low).norm();
}

// A mesh solver derives from this class and implements search(). `Tree` is a tree or a grid over B that finds closest
// points. It is not built if B is so small that testing all triangles is as fast. A solver that needs further
// structures overrides needs() and prepare(), and calls the functions of this class from them.
template <class Tree> class MeshSolver : public Solver {
    static constexpr bool is_tree = std::derived_from<Tree, TriangleTree>;

public:
    // The type of the tree over A (source_regions.h).
    using RegionTree = std::conditional_t<is_tree, Tree, TriangleBvh>;

    Needs needs(const Scene& scene, const QuerySet&) const override {
        Needs needs;
        if (element_count(scene.target) > scan_at_most) needs.push_back(need<Tree>(Side::target));
        if (has_regions(scene)) needs.push_back(need<RegionTree>(Side::source));
        return needs;
    }

    void prepare(const Scene& scene, const Prepared& prepared) override {
        source_ = &prepared.triangles(Side::source);
        target_ = &prepared.triangles(Side::target);
        tree_ = prepared.has<Tree>(Side::target) ? &prepared.get<Tree>(Side::target) : nullptr;
        source_tree_ = has_regions(scene) ? &prepared.get<RegionTree>(Side::source) : nullptr;
    }

    Result solve(const Query& query, State* state, Trace& trace) const final {
        const bool moved = !query.source_pose.is_identity();
        const Points after = moved ? posed(source_->vertices, query.source_pose) : Points();
        const Points& points = moved ? after : source_->vertices;
        const double most = std::max(WATCHED("mesh solvers: the coordinates of A count", magnitude(points)),
                                     WATCHED("mesh solvers: the coordinates of B count", magnitude(target_->vertices)));
        // Outside this range the rounding errors are not bounded, so the result is `stalled`, with the bounds 0 and
        // infinity.
        if (!(most == 0 || (most >= smallest_safe_magnitude && most <= largest_safe_magnitude))) return {};
        const Target target = [&] {
            if constexpr (is_tree)
                return Target(*target_, tree_, textbook_);
            else
                return Target(*target_, tree_);
        }();
        return search({*source_, points, target, most, source_tree_}, query, state, trace);
    }

protected:
    explicit MeshSolver(bool textbook = false, bool regions = false) : textbook_(textbook), regions_(regions) {}

    // Returns whether to skip groups of triangles of A in this scene (source_regions.h). The answer does not depend on
    // which structures were built.
    bool has_regions(const Scene& scene) const { return regions_ && element_count(scene.source) > scan_at_most; }

    const TriangleMesh& source() const { return *source_; }
    const Tree* tree() const { return tree_; }  // null if B is scanned

private:
    virtual Result search(const MeshPair& pair, const Query& query, State* state, Trace& trace) const = 0;

    bool textbook_;  // see Target
    bool regions_;   // see has_regions()
    const TriangleMesh* source_ = nullptr;
    const TriangleMesh* target_ = nullptr;
    const Tree* tree_ = nullptr;
    const RegionTree* source_tree_ = nullptr;
};

// Returns the common part of the SolverInfo of mesh solvers: certified, accepts meshes and point sets on either side,
// records traces and gives fields. Each solver adds its other abilities, structures and parameters.
template <class Tree> SolverInfo mesh_solver_info(std::string name, std::string title, std::string paper) {
    SolverInfo info;
    info.name = std::move(name);
    info.title = std::move(title);
    info.paper = std::move(paper);
    info.source.mesh = info.source.points = info.target.mesh = info.target.points = true;
    info.certified = true;
    info.abilities = {Ability::traces, Ability::coarser_answers, Ability::fields, Ability::undone_motion};
    info.may_need = {need<Tree>(Side::target)};
    return info;
}

// Returns the parameter `regions`: whether to skip groups of triangles of A by a tree over A (source_regions.h). A
// solver with this parameter must list such a tree in its SolverInfo::may_need.
inline ParameterSpec regions_parameter(bool by_default, std::string paper_value) {
    return {.name = "regions",
            .default_value = by_default,
            .paper_value = std::move(paper_value),
            .description =
                "settle whole groups of triangles of A by the boxes of a tree over A, which takes time to build; off: "
                "measure every vertex of A"};
}

}  // namespace hausbench
