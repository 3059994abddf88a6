// Octree subdivision with interval distances, as published.
//
// Source: Shou, Huang, Gu, Miao, Wang: Computing the Hausdorff distance between two algebraic surfaces, Computer
// Science and Application 3, 2013 (in Chinese; read in a poor text recognition, so the denominators in the equations of
// its surfaces were inferred from the interval that it prints). An octree divides the box into 2^depth voxels per axis
// and keeps a cell if the interval of the polynomial over it contains 0. The answer is [max over A of min over B of g,
// max over A of min over B of G], where g is the least and G the largest distance between points of two kept voxels.
// For H(A,B), the paper takes the larger of the lower ends and the larger of the upper ends of h(A,B) and h(B,A), so
// ask for both directions.
//
// Not certified: a kept voxel need not contain a point of the surface, so either end may be wrong. The interval is
// reported as the method gives it, without a witness. Use surface_enclosure.cpp for bounds that hold.
//
// `pairs = all` computes the distance of every pair of voxels, as the paper does; `pruned` gives the same bits from
// fewer pairs (voxel_distances.h). Budget: voxels of A (all), or searches over the voxels of B (pruned).
//
// Polynomials are bounded with directed rounding (voxels.h); squared distances are rounded to nearest and widened at
// the end as in kernel/rounding.h. Time: O(8^depth) in the worst case, O(4^depth) for the octree of a smooth surface,
// O(16^depth) for all pairs. Memory: O(4^depth).
#include "algorithms/kernel/rounding.h"
#include "algorithms/solver.h"
#include "algorithms/surfaces/interval_subdivision/voxel_distances.h"

#include <algorithm>

namespace hausbench::interval_subdivision {
namespace {

class IntervalSubdivision final : public Solver {
public:
    explicit IntervalSubdivision(const Options& options)
        : depth_(static_cast<int>(options.integer("depth"))), all_(options.text("pairs") == "all") {
        const std::string form = options.text("form");
        form_ =
            static_cast<Form>(std::find(std::begin(form_names), std::end(form_names), form) - std::begin(form_names));
    }

    void prepare(const Scene& scene, const Prepared&) override {
        source_ = voxels_of(surface_of(scene.source), depth_, form_);
        target_ = voxels_of(surface_of(scene.target), depth_, form_);
    }

    std::size_t prepared_bytes() const override { return source_.bytes() + target_.bytes(); }

    Result solve(const Query& query, State*, Trace& trace) const override {
        const Deadline deadline = query.deadline();
        VoxelWork work{query, deadline, {}, {}};
        work.counters.polynomial_evaluations = source_.evaluations + target_.evaluations;
        VoxelDistances squared =
            all_ ? distances_of_all(source_, target_, work) : distances_by_search(source_, target_, work);
        if (work.stopped) squared.largest = largest_squared_distance(source_.whole(), target_.whole());
        Result result;
        result.counters = work.counters;
        result.bounds = {distance_at_least(squared.least, true), distance_at_most(squared.largest, true)};
        trace.record(result.bounds.lower, result.bounds.upper);
        if (const auto answer = query.answer(result.bounds.lower, result.bounds.upper)) {
            result.status = *answer;
        } else if (work.stopped) {
            result.status = *work.stopped;
        } else {
            result.status = Status::stalled;
            result.note = "the width of the interval depends on the voxels alone: give a larger depth";
        }
        return result;
    }

private:
    int depth_;
    Form form_ = Form::modified_affine;
    bool all_;
    Voxels source_, target_;
};

}  // namespace

SolverEntry solver() {
    SolverInfo info;
    info.name = "interval_subdivision";
    info.title = "interval subdivision";
    info.paper = "shou2014";
    info.source.surface = info.target.surface = true;
    info.abilities.insert({Ability::traces, Ability::coarser_answers});
    info.parameters = {
        {.name = "depth",
         .default_value = std::int64_t{6},
         .paper_value = "6",
         .description = "depth of the octree: 2^depth voxels along each axis",
         .least = 1,
         .most = 10},
        {.name = "form",
         .default_value = std::string("modified_affine"),
         .paper_value = "modified affine arithmetic",
         .description = "how the polynomial is bounded over a cell",
         .choices = {std::begin(form_names), std::end(form_names)}},
        {.name = "pairs",
         .default_value = std::string("all"),
         .paper_value = "all",
         .description = "pairs of voxels whose distance is computed; 'pruned' leaves out those that cannot matter",
         .choices = {"all", "pruned"}},
    };
    return {info, make_solver<IntervalSubdivision>};
}

}  // namespace hausbench::interval_subdivision
