// LSS, local start search: EARLYBREAK on sorted sets, in which each scan of B starts where the previous one stopped.
//
// Source: Chen, He, Wu, Hou: A local start search algorithm to compute exact Hausdorff distance for arbitrary point
// sets, Pattern Recognition 67, 2017. Both sets are sorted along a Morton curve, so that neighbours in the order are
// mostly neighbours in space. The point of B that ends a scan is therefore likely near the next point of A, too. A scan
// starts there and goes on alternately to both sides. As in EARLYBREAK, it ends at the first point of B that is closer
// than the largest distance so far. A scan that visits all of B changes the largest distance, but not the start.
//
// Written from the description in the abstract; the paper's pseudocode may differ in details. Ours are: keys of 10 bits
// a coordinate in the box of the set, refined where points share a cell (kernel/morton.h); the order of A is computed
// once, before it is moved. `sort` can be turned off for sets that are in such an order already, as voxels of a grid.
// O(|A|) to O(|A| |B|) time, O(|A| + |B|) memory. The unit of Query::budget is one point of A.
#include "algorithms/kernel/morton.h"
#include "algorithms/kernel/posed_box.h"
#include "algorithms/points/exact.h"
#include "algorithms/points/point_solver.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace hausbench::lss {
namespace {

// Returns the rows of the points, along a Morton curve if `sort` is set.
std::vector<Index> scan_order(const Points& points, bool sort) {
    if (sort) return morton_order(points, nullptr, MortonFrame(box_of(points)));
    std::vector<Index> order(static_cast<std::size_t>(points.rows()));
    std::iota(order.begin(), order.end(), Index{0});
    return order;
}

class LocalStartSearch final : public Solver {
public:
    explicit LocalStartSearch(const Options& options) : sort_(options.flag("sort")) {}

    void prepare(const Scene& scene, const Prepared&) override {
        scene_ = &scene;
        source_order_ = scan_order(points_of(scene.source), sort_);
        const Points& b = points_of(scene.target);
        target_order_ = scan_order(b, sort_);
        target_.resize(b.rows(), 3);
        for (Index j = 0; j < b.rows(); ++j) target_.row(j) = b.row(target_order_[static_cast<std::size_t>(j)]);
    }

    std::size_t prepared_bytes() const override {
        return (source_order_.capacity() + target_order_.capacity()) * sizeof(Index) +
               static_cast<std::size_t>(target_.size()) * sizeof(double);
    }

    Result solve(const Query& query, State*, Trace& trace) const override {
        const Points a = posed(points_of(scene_->source), query.source_pose);
        const Points& b = points_of(scene_->target);
        if (out_of_range(a, b)) return {};

        const Deadline deadline = query.deadline();
        Counters counters;
        FarthestPoint farthest;
        Index start = 0;
        for (Index row = 0; row < a.rows(); ++row) {
            const Index i = source_order_[static_cast<std::size_t>(row)];
            Status stopped = Status::converged;
            if (static_cast<std::uint64_t>(row) >= query.budget) stopped = Status::budget;
            if (stopped == Status::converged && !scan(a, i, deadline, start, farthest, counters))
                stopped = Status::time_limit;
            record(trace, farthest.squared);
            if (distance_at_least(farthest.squared, true) > query.cutoff) stopped = Status::above_cutoff;
            if (stopped != Status::converged) {
                const double rest = squared_distances_at_most(a, b, source_order_.data(), row);
                return exact_result(query, a, b, farthest, counters, rest, stopped);
            }
        }
        return exact_result(query, a, b, farthest, counters);
    }

private:
    // Compares point i of A with the points of B, from `start` to both sides, and updates `farthest` and `start`.
    // Returns false if time runs out first; point i then counts as not examined.
    bool scan(const Points& a, Index i, const Deadline& deadline, Index& start, FarthestPoint& farthest,
              Counters& counters) const {
        constexpr Index block = 2048;  // steps between two checks of the clock
        const double* point = a.row(i).data();
        const auto count = static_cast<Index>(target_.rows());
        double nearest = std::numeric_limits<double>::infinity();
        Index at = -1;
        const auto breaks = [&](Index j) {
            ++counters.point_distances;
            const double squared = squared_distance(point, target_.row(j).data());
            if (squared < farthest.squared) {
                start = j;
                return true;
            }
            if (squared < nearest) {
                nearest = squared;
                at = j;
            }
            return false;
        };
        const Index first = start, steps = std::max(first + 1, count - first);
        for (Index step = 0; step < steps; ++step) {
            if (step % block == 0 && deadline.passed()) return false;
            if (step <= first && breaks(first - step)) return true;
            if (step > 0 && first + step < count && breaks(first + step)) return true;
        }
        if (nearest > farthest.squared) farthest = {nearest, i, target_order_[static_cast<std::size_t>(at)]};
        return true;
    }

    bool sort_;
    const Scene* scene_ = nullptr;
    std::vector<Index> source_order_, target_order_;
    Points target_;  // B in the order `target_order_`
};

}  // namespace

SolverEntry solver() {
    SolverInfo info = point_solver_info("lss", "LSS", "chen2017");
    info.certified = true;
    info.parameters = {
        {.name = "sort",
         .default_value = true,
         .paper_value = "on, for general point sets",
         .description = "sort both sets along a Morton curve first"},
    };
    return {info, make_solver<LocalStartSearch>};
}

}  // namespace hausbench::lss
