// A simple baseline: searches a k-d tree over B (library nanoflann) for the nearest point of B to each point of A. A
// search stops at the first point of B within the largest distance so far, because the point of A then cannot raise
// that distance. The points of A that are probably farthest come first, so that most searches stop early.
//
// Certified although nanoflann gives no guarantee; checked_result.h explains why. Time: O(|A| log |B| + |B|) on typical
// data. Memory: O(|A| + |B|). The unit of Query::budget is one point of A.
#include "algorithms/kernel/deadline.h"
#include "algorithms/peers/checked_result.h"

#include <algorithm>

#include <nanoflann.hpp>

namespace hausbench::kdtree {
namespace {

// The interface through which nanoflann reads the points; it does not copy them.
struct PointsAdaptor {
    const Points* points = nullptr;
    std::size_t kdtree_get_point_count() const { return static_cast<std::size_t>(points->rows()); }
    double kdtree_get_pt(std::size_t i, std::size_t k) const {
        return (*points)(static_cast<Index>(i), static_cast<Index>(k));
    }
    template <class BoundingBox> bool kdtree_get_bbox(BoundingBox&) const { return false; }  // computed by nanoflann
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointsAdaptor>, PointsAdaptor, 3>;

// A result set, as nanoflann calls it: receives the points that a search finds. Keeps the nearest one, and ends the
// search at the first point with a squared distance of at most `enough`.
struct NearestOrEnough {
    using DistanceType = double;
    using IndexType = std::uint32_t;
    double enough;
    Counters& counters;
    double squared = std::numeric_limits<double>::infinity();
    Index at = -1;

    std::size_t size() const { return at < 0 ? 0 : 1; }
    bool full() const { return at >= 0; }
    double worstDist() const { return squared; }
    bool addPoint(double candidate, std::size_t index) {
        ++counters.point_distances;
        if (candidate < squared) {
            squared = candidate;
            at = static_cast<Index>(index);
        }
        return squared > enough;  // false ends the search
    }
    void sort() {}  // there is one point at most
};

class KdTree final : public Solver {
public:
    explicit KdTree(const Options& options)
        : leaf_size_(static_cast<std::size_t>(options.integer("leaf_size"))),
          samples_(static_cast<Index>(options.integer("samples"))) {}

    void prepare(const Scene& scene, const Prepared&) override {
        scene_ = &scene;
        adaptor_.points = &points_of(scene.target);
        tree_ = std::make_unique<Tree>(3, adaptor_, nanoflann::KDTreeSingleIndexAdaptorParams(leaf_size_));
    }

    std::size_t prepared_bytes() const override { return tree_->usedMemory(*tree_); }

    Result solve(const Query& query, State*, Trace&) const override {
        const Points a = posed(points_of(scene_->source), query.source_pose);
        const Points& b = points_of(scene_->target);
        if (out_of_range(a, b)) return {};

        const Deadline deadline = query.deadline();
        Counters counters;
        FarthestPoint farthest;
        const std::vector<Index> order = likely_farthest_first(a, b, counters);
        for (Index row = 0; row < a.rows(); ++row) {
            const Index i = order[static_cast<std::size_t>(row)];
            Status stopped = Status::converged;
            if (static_cast<std::uint64_t>(row) >= query.budget) stopped = Status::budget;
            if (row % 256 == 0 && deadline.passed()) stopped = Status::time_limit;
            if (stopped != Status::converged) {
                const double rest = squared_distances_at_most(a, b, order.data(), row);
                return checked_result(query, a, b, farthest, counters, rest, stopped);
            }
            NearestOrEnough nearest{farthest.squared, counters};
            ++counters.closest_point_queries;
            tree_->findNeighbors(nearest, a.row(i).data(), {});
            if (nearest.squared > farthest.squared) farthest = {nearest.squared, i, nearest.at};
        }
        return checked_result(query, a, b, farthest, counters);
    }

private:
    // Returns the rows of A in the order in which to search. Finds, for each point of A, the nearest of `samples_`
    // points of B. The 1/64 of A for which this distance is largest come first, in descending order of the distance.
    // The others follow in ascending order.
    std::vector<Index> likely_farthest_first(const Points& a, const Points& b, Counters& counters) const {
        const auto count = static_cast<std::size_t>(a.rows());
        const Index samples = std::min<Index>(samples_, static_cast<Index>(b.rows()));
        std::vector<std::pair<double, Index>> keys(count);
        for (std::size_t i = 0; i < count; ++i) {
            double nearest = std::numeric_limits<double>::infinity();
            for (Index k = 0; k < samples; ++k) {
                const auto j = static_cast<Index>(static_cast<std::int64_t>(b.rows()) * k / samples);
                nearest = std::min(nearest, squared_distance(a.row(static_cast<Index>(i)).data(), b.row(j).data()));
            }
            keys[i] = {-nearest, static_cast<Index>(i)};
        }
        counters.point_distances += count * static_cast<std::uint64_t>(samples);
        const auto head = keys.begin() + static_cast<std::ptrdiff_t>((count + 63) / 64);
        if (samples > 0) {
            std::nth_element(keys.begin(), head - 1, keys.end());
            std::sort(keys.begin(), head);
            std::sort(head, keys.end(), [](const auto& x, const auto& y) { return x.second < y.second; });
        }
        std::vector<Index> order(count);
        for (std::size_t i = 0; i < count; ++i) order[i] = keys[i].second;
        return order;
    }

    std::size_t leaf_size_;
    Index samples_;
    const Scene* scene_ = nullptr;
    PointsAdaptor adaptor_;
    std::unique_ptr<Tree> tree_;
};

}  // namespace

SolverEntry solver() {
    SolverInfo info;
    info.name = "kdtree";
    info.title = "k-d tree (nanoflann)";
    info.paper = "nanoflann";
    info.source.points = info.target.points = true;
    info.certified = true;
    info.ignores_tolerance = true;
    info.parameters = {
        {.name = "leaf_size",
         .default_value = std::int64_t{10},
         .unit = "points",
         .description = "most points in a leaf of the tree; nanoflann's default",
         .least = 1,
         .most = 1e6},
        {.name = "samples",
         .default_value = std::int64_t{16},
         .unit = "points",
         .description = "number of points of B that determine which points of A come first; 0: keep the order of A",
         .least = 0,
         .most = 1e6},
    };
    return {info, [](const Options& options) -> std::unique_ptr<Solver> { return std::make_unique<KdTree>(options); }};
}

}  // namespace hausbench::kdtree
