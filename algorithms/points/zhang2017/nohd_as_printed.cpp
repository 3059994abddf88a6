// NOHD as printed, to show the effect of its error: Zhang et al. 2017, Algorithms 3 and 5; Algorithm 4 is in nohd.h.
//
// The error: Algorithm 5 computes cmin, the smallest distance of one point of A to B. If it finds a point of B closer
// than the lower bound, it breaks off without setting cmin to 0. It then returns the minimum of the points before,
// which may be infinity, and the lower bound becomes too large. nohd.cpp has the correction.
//
// One thing is not as printed: the search stops once the upper bound at the head of the queue is at most the lower
// bound, as in nohd.cpp. If the queue were emptied, even more answers would be infinite. O(|A| |B|) time. The unit of
// Query::budget is one cell taken from the queue.
#include "algorithms/kernel/deadline.h"
#include "algorithms/points/point_solver.h"
#include "algorithms/points/zhang2017/nohd.h"
#include "algorithms/points/zhang2017/octree_cursor.h"

#include <optional>
#include <queue>

namespace hausbench::zhang2017 {
namespace {

class NohdAsPrinted final : public Solver {
public:
    explicit NohdAsPrinted(const Options& options) : depth_(static_cast<int>(options.integer("depth"))) {}

    Needs needs(const Scene&, const QuerySet&) const override { return {need<PointOctree>(Side::source)}; }

    void prepare(const Scene& scene, const Prepared& prepared) override {
        scene_ = &scene;
        tree_ = &prepared.get<PointOctree>(Side::source);
    }

    // Algorithm 3 of the paper.
    Result solve(const Query& query, State*, Trace&) const override {
        const Points a = posed(points_of(scene_->source), query.source_pose);
        const Points& b = points_of(scene_->target);
        if (out_of_range(a, b)) return {};
        const Box around = box_of(a);
        const Deadline deadline = query.deadline();
        Counters counters;
        FarthestPoint farthest;
        double max_lb = 0;                        // the lower bound so far, squared; the paper's MaxLB
        Index shows_it = tree_->order().front();  // a point of the cell that gave MaxLB
        std::priority_queue<NohdEntry> queue;
        queue.push({infinity, 0, root_of(*tree_)});
        for (std::uint64_t taken = 0; !queue.empty(); ++taken) {
            const NohdEntry head = queue.top();
            if (head.squared_upper <= max_lb) break;
            if (const auto stopped = why_stop(query, taken, deadline)) {
                const double rest = squared_distances_at_most(a, b, nullptr, 0);
                return exact_result(query, a, b, farthest, counters, rest, *stopped);
            }
            queue.pop();
            const PointOctree::Node& node = tree_->nodes()[static_cast<std::size_t>(head.cell.node)];
            if (head.cell.depth < depth_) {
                for_each_part(*tree_, head.cell, [&](const Cursor& part) {
                    const Box box = posed_box(part.cell, query.source_pose, around);
                    const auto [upper, lower, undecided] = cell_to_points(box, b, max_lb, true, counters);
                    if (!undecided) return;
                    if (lower > max_lb) {
                        max_lb = lower;
                        shows_it = first_point(*tree_, part);
                    }
                    ++counters.queue_pushes;
                    queue.push({upper, counters.queue_pushes, part});
                });
                continue;
            }
            for (std::int32_t k = node.first; k < node.first + node.count; ++k) {
                const Index i = tree_->order()[static_cast<std::size_t>(k)];
                const FarthestPoint candidate = point_to_points(a, i, b, max_lb, counters);
                if (candidate.squared > farthest.squared) farthest = candidate;
                max_lb = std::max(max_lb, candidate.squared);
            }
        }
        // The largest lower bound, MaxLB, may come from a cell. At the end, no point of A is farther from B than MaxLB,
        // and no point of that cell is nearer, so the points of the cell are at exactly this distance. Compares one of
        // them with all of B to find its nearest point.
        if (farthest.squared < max_lb || farthest.source < 0) farthest = point_to_points(a, shows_it, b, -1, counters);
        return exact_result(query, a, b, farthest, counters);
    }

private:
    static std::optional<Status> why_stop(const Query& query, std::uint64_t taken, const Deadline& deadline) {
        if (taken >= query.budget) return Status::budget;
        if (deadline.passed()) return Status::time_limit;
        return std::nullopt;
    }

    // Algorithm 5 of the paper: returns point i of A, its nearest point of B and their squared distance cmin. With the
    // error as printed, cmin may be too large.
    static FarthestPoint point_to_points(const Points& a, Index i, const Points& b, double squared_max_lb,
                                         Counters& counters) {
        FarthestPoint cmin{infinity, i, 0};
        for (Index j = 0; j < b.rows(); ++j) {
            ++counters.point_distances;
            const double squared = squared_distance(a.row(i).data(), b.row(j).data());
            if (squared < squared_max_lb) break;  // the error: cmin <- 0 is missing
            if (squared < cmin.squared) {
                cmin.squared = squared;
                cmin.target = j;
            }
        }
        return cmin;
    }

    int depth_;
    const Scene* scene_ = nullptr;
    const PointOctree* tree_ = nullptr;
};

}  // namespace

}  // namespace hausbench::zhang2017

namespace hausbench::nohd_as_printed {

using namespace zhang2017;

SolverEntry solver() {
    SolverInfo info = point_solver_info("nohd_as_printed", "NOHD as printed", "zhang2017");
    info.abilities.erase(Ability::traces);
    info.known_wrong = "Algorithm 5 of the paper breaks without cmin <- 0: answers too large, even infinite";
    info.may_need = {need<PointOctree>(Side::source)};
    info.parameters = {
        nohd_depth_parameter(),
    };
    return {info, make_solver<NohdAsPrinted>};
}

}  // namespace hausbench::nohd_as_printed
