// OHD: finds the nearest point of B for each point of A in an octree of B. A point of A in a small cell that also
// contains a point of B is so near to B that it cannot raise the lower bound; it is culled, that is, skipped.
//
// Source: Zhang et al. 2017, Algorithms 6 and 7 (line 6 of Algorithm 6 lacks the argument Maxlb) and sections 4.4.1 and
// 4.4.2. The first lower bound, called AHD, comes from EARLYBREAK on a sample of ceil(lambda * |A|) points of A. Then
// all points of A are culled or searched for, in the given order. There are two changes:
//   - As printed, a point of A is culled if its cell, of side AHD, contains a point of B. This is wrong: the two points
//     may be sqrt(3) * AHD apart. Here a point of A is culled if a cell with a diagonal of at most the lower bound so
//     far contains it and a point of B (`culling = exact`). Searches treat cells with a diagonal of at most AHD as
//     leaves. `culling = as_printed` selects ohd_as_printed.cpp, which is not certified.
//   - A search stops when the lower bound at the head of its queue reaches the nearest distance found. The paper
//     empties the queue.
//
// The octree is built once, down to single points. Time: O(lambda |A| |B|) in the worst case for AHD, then O(|A| log
// |B|) on typical data. Memory: O(|A| + |B|). The unit of Query::budget is one point of A; the points of the sample
// count, too.
#include "algorithms/points/zhang2017/ohd.h"
#include "algorithms/kernel/deadline.h"
#include "algorithms/kernel/posed_box.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/points/point_solver.h"
#include "algorithms/points/zhang2017/octree_cursor.h"

#include <algorithm>
#include <optional>
#include <span>

namespace hausbench::zhang2017 {
namespace {

class OhdSearch {
public:
    OhdSearch(const PointOctree& tree, const Points& a, const Points& b, const Query& query, Trace& trace)
        : tree_(tree), a_(a), b_(b), query_(query), trace_(trace), deadline_(query.deadline()) {}

    // Algorithm 6 of the paper: gets the first lower bound from the sample, then examines all points of A.
    Result run(std::span<const Index> sample, const ShuffledTarget& target, bool culling) {
        std::uint64_t taken = 0, culled = 0;
        for (const Index i : sample) {
            if (const Status stopped = stop(taken++, true); stopped != Status::converged) return finish(0, 0, stopped);
            if (!early_break(a_, i, target, deadline_, farthest_, counters_)) return finish(0, 0, Status::time_limit);
        }
        squared_resolution_ = farthest_.squared;
        for (Index i = 0; i < a_.rows(); ++i) {
            const Status stopped = stop(taken++, i % 64 == 0);
            if (stopped != Status::converged) return finish(culled, i, stopped);
            const Vec3 point = a_.row(i);
            if (culling && lies_near(point)) {
                ++culled;
            } else {
                look_at(i, point);
            }
        }
        return finish(culled, static_cast<Index>(a_.rows()), Status::converged);
    }

private:
    // Returns the reason to stop, or `converged` to go on.
    Status stop(std::uint64_t taken, bool look_at_clock) const {
        record(trace_, farthest_.squared);
        if (distance_at_least(std::max(farthest_.squared, 0.0), true) > query_.cutoff) return Status::above_cutoff;
        if (look_at_clock && deadline_.passed()) return Status::time_limit;
        return taken >= query_.budget ? Status::budget : Status::converged;
    }

    // Returns whether a cell with a diagonal of at most the lower bound contains this point of A and a point of B. The
    // point of A then cannot raise the lower bound. The diagonal is rounded like a distance, so this also holds for
    // computed distances.
    bool lies_near(const Vec3& point) {
        if (farthest_.squared <= 0) return false;
        Cursor at = root_of(tree_);
        if ((point.array() < at.cell.low.array()).any() || (point.array() > at.cell.high.array()).any()) return false;
        while (true) {
            ++counters_.node_visits;
            if (squared_distance_at_most(at.cell, at.cell) <=
                WATCHED_ELSE("OHD: the diagonal, not the side, of the cell that culls", farthest_.squared,
                             3 * farthest_.squared))
                return true;
            if (at.depth >= PointOctree::max_depth) return false;
            const int octant = octant_of(at.cell, point);
            std::optional<Cursor> next;
            for_each_part(tree_, at, [&](const Cursor& part) {
                if (octant_of(at.cell, tree_.points().row(node(part.node).first)) == octant) next = part;
            });
            if (!next) return false;
            at = *next;
        }
    }

    // Algorithm 7 of the paper: finds the nearest point of B to point i of A, nearest cells first, and updates
    // `farthest_`. Stops at the first point of B within the lower bound, because point i then cannot raise it.
    void look_at(Index i, const Vec3& point) {
        ++counters_.closest_point_queries;
        double nearest = std::numeric_limits<double>::infinity();
        Index at = -1;
        queue_.assign(1, {0, 0});
        while (!queue_.empty()) {
            std::pop_heap(queue_.begin(), queue_.end());
            const Near head = queue_.back();
            queue_.pop_back();
            if (head.squared_lower >= nearest) break;
            const PointOctree::Node& cell = node(head.node);
            if (cell.child_count == 0 || squared_distance_at_most(cell.cell, cell.cell) <= squared_resolution_) {
                for (std::int32_t k = cell.first; k < cell.first + cell.count; ++k) {
                    ++counters_.point_distances;
                    const double squared = squared_distance(point.data(), tree_.points().row(k).data());
                    if (squared <= farthest_.squared) return;
                    if (squared < nearest) {
                        nearest = squared;
                        at = tree_.order()[static_cast<std::size_t>(k)];
                    }
                }
                continue;
            }
            for (std::int32_t k = cell.first_child; k < cell.first_child + cell.child_count; ++k) {
                ++counters_.node_visits;
                const double lower = squared_distance_to_box(point, node(k).cell);
                if (lower >= nearest) continue;
                ++counters_.queue_pushes;
                queue_.push_back({lower, k});
                std::push_heap(queue_.begin(), queue_.end());
            }
        }
        if (nearest > farthest_.squared) farthest_ = {nearest, i, at};
    }

    // Returns the result, given that the rows of A from `first` on were not examined.
    Result finish(std::uint64_t culled, Index first, Status stopped) {
        const double rest = squared_distances_at_most(a_, b_, nullptr, first);
        Result result = exact_result(query_, a_, b_, farthest_, counters_, rest, stopped);
        result.reported["culled"] = static_cast<double>(culled);
        return result;
    }

    const PointOctree::Node& node(std::int32_t i) const { return tree_.nodes()[static_cast<std::size_t>(i)]; }

    // A node in the queue of look_at(), and a lower bound on its squared distance to the point of A.
    struct Near {
        double squared_lower;
        std::int32_t node;
        bool operator<(const Near& other) const {  // puts the nearest on top of a heap
            return squared_lower != other.squared_lower ? squared_lower > other.squared_lower : node > other.node;
        }
    };

    const PointOctree& tree_;
    const Points &a_, &b_;
    const Query& query_;
    Trace& trace_;
    Deadline deadline_;
    Counters counters_;
    FarthestPoint farthest_;          // its distance is the lower bound so far
    double squared_resolution_ = -1;  // square of AHD: cells with at most this diagonal are leaves
    std::vector<Near> queue_;         // a heap, kept here so that its memory is reused
};

class Ohd final : public Solver {
public:
    explicit Ohd(const Options& options)
        : culling_(options.text("culling") == "exact"),
          lambda_(options.real("lambda")),
          seed_(static_cast<std::uint64_t>(options.integer("seed"))) {}

    Needs needs(const Scene&, const QuerySet&) const override { return {need<PointOctree>(Side::target)}; }

    void prepare(const Scene& scene, const Prepared& prepared) override {
        scene_ = &scene;
        tree_ = &prepared.get<PointOctree>(Side::target);
        Generator random(seed_);
        sample_ = first_of_order(element_count(scene.source), lambda_, random);
        target_ = ShuffledTarget(points_of(scene.target), true, random);
    }

    std::size_t prepared_bytes() const override { return sample_.capacity() * sizeof(Index) + target_.bytes(); }

    Result solve(const Query& query, State*, Trace& trace) const override {
        const Points a = posed(points_of(scene_->source), query.source_pose);
        const Points& b = points_of(scene_->target);
        if (out_of_range(a, b)) return {};
        return OhdSearch(*tree_, a, b, query, trace).run(sample_, target_, culling_);
    }

private:
    bool culling_;
    double lambda_;
    std::uint64_t seed_;
    const Scene* scene_ = nullptr;
    const PointOctree* tree_ = nullptr;
    std::vector<Index> sample_;  // rows of A that give AHD
    ShuffledTarget target_;
};

}  // namespace

}  // namespace hausbench::zhang2017

namespace hausbench::ohd_as_printed {
SolverEntry solver();
}

namespace hausbench::ohd {

using namespace zhang2017;

SolverEntry solver() {
    SolverInfo info = point_solver_info("ohd", "OHD", "zhang2017");
    info.certified = true;
    info.may_need = {need<PointOctree>(Side::target)};
    info.parameters = ohd_parameters();
    info.parameters.push_back({.name = "culling",
                               .default_value = std::string("exact"),
                               .paper_value = "as_printed",
                               .description =
                                   "leave out points of A in a cell of B whose diagonal is at most the lower bound; "
                                   "as_printed: whose side is, which is wrong, and not certified",
                               .choices = {"exact", "as_printed", "none"}});
    return {info, [](const Options& options) -> std::unique_ptr<Solver> {
                if (options.text("culling") == "as_printed") return ohd_as_printed::solver().make(options);
                return std::make_unique<Ohd>(options);
            }};
}

}  // namespace hausbench::ohd
