// EARLYBREAK: discards a point of A as soon as some point of B is closer than the largest distance so far.
//
// Source: Taha, Hanbury: An efficient algorithm for calculating the exact Hausdorff distance, IEEE TPAMI 37, 2015, as
// given by Zhang et al. 2017, Algorithm 2. That version sets cmin, the smallest distance of the current point of A, to
// 0 before the break, so that a discarded point cannot raise the result. The first print omits this and may return the
// smallest distance found before the break. The option `exclude_common` skips points of A that are also in B, because
// their distance is 0. O(|A|) to O(|A| |B|) time, O(|A| + |B|) memory. The unit of Query::budget is one point of A.
#include "algorithms/points/early_break.h"
#include "algorithms/points/point_solver.h"

#include <algorithm>
#include <array>

namespace hausbench::earlybreak {
namespace {

// Returns the coordinates of point i as a sort key. Adding 0.0 turns -0 into +0, so that equal coordinates have equal
// keys.
std::array<double, 3> key_of(const Points& points, Index i) {
    return {points(i, 0) + 0.0, points(i, 1) + 0.0, points(i, 2) + 0.0};
}

class EarlyBreak final : public Solver {
public:
    explicit EarlyBreak(const Options& options)
        : seed_(static_cast<std::uint64_t>(options.integer("seed"))),
          shuffle_(options.flag("shuffle")),
          exclude_common_(options.flag("exclude_common")) {}

    void prepare(const Scene& scene, const Prepared&) override {
        scene_ = &scene;
        Generator random(seed_);
        const Points& b = points_of(scene.target);
        source_order_ = order_of(element_count(scene.source), shuffle_, random);
        target_ = ShuffledTarget(b, shuffle_, random);
        if (!exclude_common_) return;
        for (Index j = 0; j < b.rows(); ++j) sorted_target_.push_back({key_of(b, j), j});
        std::sort(sorted_target_.begin(), sorted_target_.end());
    }

    std::size_t prepared_bytes() const override {
        return source_order_.capacity() * sizeof(Index) + target_.bytes() +
               sorted_target_.capacity() * sizeof(sorted_target_[0]);
    }

    Result solve(const Query& query, State*, Trace& trace) const override {
        const Points a = posed(points_of(scene_->source), query.source_pose);
        const Points& b = points_of(scene_->target);
        if (out_of_range(a, b)) return {};

        const Deadline deadline = query.deadline();
        Counters counters;
        FarthestPoint farthest;
        const bool traced = trace.on() || trace.watched();
        for (Index row = 0; row < a.rows(); ++row) {
            const Index i = source_order_[static_cast<std::size_t>(row)];
            Status stopped = Status::converged;
            if (static_cast<std::uint64_t>(row) >= query.budget) stopped = Status::budget;
            if (stopped == Status::converged && !excluded(a, i, farthest) &&
                !early_break(a, i, target_, deadline, farthest, counters)) {
                stopped = Status::time_limit;
            }
            if (traced) record(trace, farthest.squared);
            if (distance_at_least(farthest.squared, true) > query.cutoff) stopped = Status::above_cutoff;
            if (stopped != Status::converged) {
                const double rest = squared_distances_at_most(a, b, source_order_.data(), row);
                return exact_result(query, a, b, farthest, counters, rest, stopped);
            }
        }
        return exact_result(query, a, b, farthest, counters);
    }

private:
    // Returns whether B contains point i of A, so that the point can be skipped. If no point was examined before,
    // `farthest` becomes this point and its copy in B, at distance 0. So there is a witness even if all points are
    // skipped.
    bool excluded(const Points& a, Index i, FarthestPoint& farthest) const {
        if (!exclude_common_) return false;
        const std::array<double, 3> key = key_of(a, i);
        const auto entry = std::lower_bound(sorted_target_.begin(), sorted_target_.end(), std::pair{key, Index{0}});
        if (entry == sorted_target_.end() || entry->first != key) return false;
        if (farthest.source < 0) farthest = {0, i, entry->second};
        return true;
    }

    std::uint64_t seed_;
    bool shuffle_, exclude_common_;
    const Scene* scene_ = nullptr;
    std::vector<Index> source_order_;
    ShuffledTarget target_;
    std::vector<std::pair<std::array<double, 3>, Index>> sorted_target_;  // key and row; only for exclude_common
};

}  // namespace

SolverEntry solver() {
    SolverInfo info = point_solver_info("earlybreak", "EARLYBREAK", "taha2015");
    info.certified = true;
    info.parameters = {
        seed_parameter(),
        {.name = "shuffle",
         .default_value = true,
         .paper_value = "randomize(A), randomize(B)",
         .description = "scan both sets in random order"},
        {.name = "exclude_common",
         .default_value = false,
         .paper_value = "on, for voxel data",
         .description = "leave out points of A that are points of B as well"},
    };
    return {info, make_solver<EarlyBreak>};
}

}  // namespace hausbench::earlybreak
