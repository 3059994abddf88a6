// Certified bounds for the distance between algebraic surfaces that close in as far as asked: this project's own.
//
// Lower bound: a point a of A is proven to exist (the polynomial changes its sign on a tiny segment in the box), and the
// boxes of an octree over B, each with a linear enclosure of its piece of B, are refined next to a until none can hold a
// point nearer than the bound. Upper bound: every point of A lies in a box of an octree over A; over the piece in such a
// box the distance to one proven point b of B is bounded from above, and no point of A is farther from B. Boxes whose upper
// bound is below the lower bound are dropped, that of the largest is split: refinement only where the answer is open.
// The maximum may lie where a box clips A: boxes and enclosures are of the clipped surface, so nothing is special there.
//
// Both bounds use that the piece in a box of size s lies within O(s^2) of a plane (surface_tree.h), so that the number of
// boxes of B does not grow as s shrinks. Where A and B are close, or run side by side, more bounds apply: surface_beside.h, and
// surface_feet.h, whose error is O(s^9). With it, boxes stay large where the distance is constant over A (concentric spheres).
//
// Surfaces are never empty (geometry.h); one that has no point in its box is refused when that is seen in preparing. Where no
// point can be proven (f = g^2 has no change of sign) bounds hold all the same, but do not close: `stalled`. So does a
// search that needs more than `most_cells` boxes, such as the lower bound at a point that is equally far from much of B.
//
// Proof of existence by a change of sign and linear enclosures by Taylor expansion are standard, see Neumaier: Interval
// methods for systems of equations, 1990; best-first refinement of A against candidates of B as in Tang, Lee, Kim 2009.
// Budget: boxes of A split. Time: boxes of A times boxes of B looked at, each O(terms of the polynomial).
#include "algorithms/error.h"
#include "algorithms/kernel/interval.h"
#include "algorithms/solver.h"
#include "algorithms/surfaces/enclosure/search.h"

#include <optional>

namespace hausbench {
namespace {

class SurfaceEnclosure final : public Solver {
public:
    explicit SurfaceEnclosure(const Options& options)
        : most_cells_(static_cast<std::size_t>(options.integer("most_cells"))) {}

    void prepare(const Scene& scene, const Prepared&) override {
        const UpwardRounding upward;
        source_.emplace(grown(surface_of(scene.source)));
        target_.emplace(grown(surface_of(scene.target)));
    }

    std::size_t prepared_bytes() const override {
        return (source_->size() + target_->size()) * sizeof(SurfaceTree::Node);
    }

    Result solve(const Query& query, State*, Trace& trace) const override {
        const UpwardRounding upward;
        return enclose(*source_, *target_, most_cells_, query, trace);
    }

private:
    // To a depth at which most surfaces that are empty are seen to be.
    static SurfaceTree grown(const AlgebraicSurface& surface) {
        constexpr int depth = 4;
        SurfaceTree tree(surface);
        Counters ignored;
        bool empty = true;
        for (std::int32_t i = 0; i < static_cast<std::int32_t>(tree.size()); ++i) {
            if (tree[i].depth < depth && tree.may_split(i))
                tree.split(i, ignored);
            else
                empty = false;
        }
        if (empty)
            throw InputError("surface '" + surface.polynomial +
                             "': has no point in its box: give another box or polynomial");
        return tree;
    }

    std::size_t most_cells_;
    std::optional<SurfaceTree> source_, target_;
};

}  // namespace

SolverEntry surface_enclosure_solver() {
    SolverInfo info;
    info.name = "surface_enclosure";
    info.title = "surface enclosure (ours)";
    info.source.surface = info.target.surface = true;
    info.certified = true;
    info.abilities.insert({Ability::traces, Ability::coarser_answers});
    info.parameters = {
        {.name = "most_cells",
         .default_value = std::int64_t{4000000},
         .unit = "boxes",
         .description = "in both trees together, of about 150 bytes each; beyond, the solver stalls",
         .least = 1000,
         .most = 1e9},
    };
    return {info, make_solver<SurfaceEnclosure>};
}

}  // namespace hausbench
