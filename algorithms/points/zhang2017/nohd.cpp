// NOHD: branch and bound over an octree of A. Compares each cell with all points of B to bound the distances of its
// points, and at the largest depth compares the points of the cell one by one. A comparison ends early if a point of B
// shows that the cell, or the point of A, cannot raise the lower bound.
//
// Source: Zhang et al. 2017, Algorithms 3 to 5, with three changes:
//   - Algorithm 5 breaks off at a point of B closer than the lower bound, but may then return a distance that is too
//     large (see nohd_as_printed.cpp). Here the point of A is discarded.
//   - The search stops once the upper bound at the head of the queue is at most the lower bound. The paper empties the
//     queue, which cannot change the answer.
//   - The bounds of a cell are squared, and each is rounded like the distance that it bounds (posed_box.h), so the
//     answer has the same bits as with NAIVEHDD. `early_break = false` is the paper's variant without early breaking:
//     Algorithm 4 without lines 5 to 8, and Algorithm 5 without lines 4 to 6.
//
// The octree of the unmoved A is built once, down to single points, so that solvers can share it; the search treats
// cells at `depth` as leaves. With `build = "to_depth"` it is built only to `depth`, as in the paper: cells and bounds
// are the same, but the points of a cell are in another order. If A moves, a cell is replaced with a box around the
// moved cell. Time: O(|A| |B|) in the worst case, O(cells * |B|), with far fewer cells than points, if A and B are far
// apart. Memory: O(|A| + |B|). The unit of Query::budget is one cell taken from the queue.
#include "algorithms/points/zhang2017/nohd.h"
#include "algorithms/kernel/deadline.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/points/point_solver.h"
#include "algorithms/points/zhang2017/octree_cursor.h"

#include <algorithm>
#include <optional>

namespace hausbench::zhang2017 {
namespace {

class NohdSearch {
public:
    NohdSearch(const PointOctree& tree, const Points& a, const Points& b, const Query& query, int depth,
               bool early_break, Trace& trace)
        : tree_(tree),
          a_(a),
          b_(b),
          query_(query),
          depth_(depth),
          early_break_(early_break),
          trace_(trace),
          a_box_(query.source_pose.is_identity() ? Box{} : box_of(a)),
          deadline_(query.deadline()) {}

    Result run() {
        std::vector<NohdEntry> queue{{std::numeric_limits<double>::infinity(), 0, root_of(tree_)}};
        witness_cell_ = queue.front().cell;
        std::uint64_t taken = 0;
        while (!queue.empty()) {
            std::pop_heap(queue.begin(), queue.end());
            const NohdEntry head = queue.back();
            if (head.squared_upper <= squared_lower_) break;
            record(trace_, squared_lower_, head.squared_upper);
            Status stopped = Status::converged;
            if (taken++ >= query_.budget) stopped = Status::budget;
            if (deadline_.passed()) stopped = Status::time_limit;
            if (distance_at_least(farthest_.squared, true) > query_.cutoff) stopped = Status::above_cutoff;
            if (stopped != Status::converged) return finish(head.squared_upper, stopped);
            queue.pop_back();
            if (head.cell.depth >= depth_) {
                if (!look_at_points(head.cell)) return finish(head.squared_upper, Status::time_limit);
                continue;
            }
            for_each_part(tree_, head.cell, [&](const Cursor& part) {
                const Box box = posed_box(part.cell, query_.source_pose, a_box_);
                const auto [upper, lower, undecided] = cell_to_points(box, b_, squared_lower_, early_break_, counters_);
                if (!undecided) return;
                if (lower > squared_lower_) {
                    squared_lower_ = lower;
                    witness_cell_ = part;
                }
                ++counters_.queue_pushes;
                queue.push_back({upper, counters_.queue_pushes, part});
                std::push_heap(queue.begin(), queue.end());
            });
        }
        return finish(-1, Status::converged);
    }

private:
    // Calls look_at() for each point of a cell. Returns false if time runs out.
    bool look_at_points(const Cursor& cell) {
        const PointOctree::Node& node = tree_.nodes()[static_cast<std::size_t>(cell.node)];
        for (std::int32_t k = node.first; k < node.first + node.count; ++k) {
            if (deadline_.passed()) return false;
            look_at(tree_.order()[static_cast<std::size_t>(k)]);
        }
        return true;
    }

    // Algorithm 5 of the paper: compares point i of A with the points of B, until one is nearer than the lower bound.
    // If none is, raises the lower bound to the distance of point i.
    void look_at(Index i) {
        const double* point = a_.row(i).data();
        double nearest = std::numeric_limits<double>::infinity();
        Index at = -1;
        for (Index j = 0; j < b_.rows(); ++j) {
            ++counters_.point_distances;
            const double squared = squared_distance(point, b_.row(j).data());
            if (early_break_ && squared < squared_lower_) {
                if (WATCHED("NOHD: cmin <- 0 of Algorithm 5", true)) return;  // point i is discarded
                break;
            }
            if (squared < nearest) {
                nearest = squared;
                at = j;
            }
        }
        if (nearest > farthest_.squared) farthest_ = {nearest, i, at};
        squared_lower_ = std::max(squared_lower_, nearest);
    }

    // Returns the result. `rest` is an upper bound on the squared distances of the points that were not examined. If
    // the lower bound comes from a cell, all its points are at least as far from B, so any of them is a witness.
    // Compares the first one with all of B to find its nearest point.
    Result finish(double rest, Status stopped) {
        if (std::isinf(rest)) rest = squared_distances_at_most(a_, b_, nullptr, 0);
        // A search that stopped early needs no witness.
        const bool shown = farthest_.source >= 0 || stopped != Status::converged;
        if (!shown || squared_lower_ > std::max(farthest_.squared, 0.0)) {
            const Index i = first_point(tree_, witness_cell_);
            farthest_ = {std::numeric_limits<double>::infinity(), i, -1};
            for (Index j = 0; j < b_.rows(); ++j) {
                const double squared = squared_distance(a_.row(i).data(), b_.row(j).data());
                if (squared < farthest_.squared) {
                    farthest_.squared = squared;
                    farthest_.target = j;
                }
            }
            counters_.point_distances += static_cast<std::uint64_t>(b_.rows());
        }
        return exact_result(query_, a_, b_, farthest_, counters_, rest, stopped);
    }

    const PointOctree& tree_;
    const Points &a_, &b_;
    const Query& query_;
    int depth_;
    bool early_break_;
    Trace& trace_;
    Box a_box_;  // the box of A, moved by its pose; left empty for the identity
    Deadline deadline_;
    Counters counters_;
    double squared_lower_ = 0;  // the lower bound so far, the paper's MaxLB
    FarthestPoint farthest_;    // among the points of A that were compared one by one
    Cursor witness_cell_;       // the last cell that raised the lower bound
};

class Nohd final : public Solver {
public:
    explicit Nohd(const Options& options)
        : depth_(static_cast<int>(options.integer("depth"))),
          early_break_(options.flag("early_break")),
          to_depth_(options.text("build") == "to_depth") {}

    Needs needs(const Scene&, const QuerySet&) const override {
        return to_depth_ ? Needs{} : Needs{need<PointOctree>(Side::source)};
    }

    void prepare(const Scene& scene, const Prepared& prepared) override {
        scene_ = &scene;
        const Points& a = points_of(scene.source);
        if (to_depth_) octree_.emplace(a, PointOctree::root_around(a), depth_);
        tree_ = to_depth_ ? &*octree_ : &prepared.get<PointOctree>(Side::source);
    }

    std::size_t prepared_bytes() const override { return octree_ ? octree_->bytes() : 0; }

    Result solve(const Query& query, State*, Trace& trace) const override {
        const Points a = posed(points_of(scene_->source), query.source_pose);
        const Points& b = points_of(scene_->target);
        if (out_of_range(a, b)) return {};
        return NohdSearch(*tree_, a, b, query, depth_, early_break_, trace).run();
    }

private:
    int depth_;
    bool early_break_, to_depth_;
    const Scene* scene_ = nullptr;
    std::optional<PointOctree> octree_;  // only for build = "to_depth"
    const PointOctree* tree_ = nullptr;  // octree_ or the shared octree
};

}  // namespace

}  // namespace hausbench::zhang2017

namespace hausbench::nohd {

using namespace zhang2017;

SolverEntry solver() {
    SolverInfo info = point_solver_info("nohd", "NOHD", "zhang2017");
    info.certified = true;
    info.may_need = {need<PointOctree>(Side::source)};
    info.parameters = {
        nohd_depth_parameter(),
        {.name = "early_break",
         .default_value = true,
         .paper_value = "on",
         .description = "stop looking through B once a cell or point can no longer be the farthest"},
        {.name = "build",
         .default_value = std::string("shared"),
         .paper_value = "to_depth",
         .description =
             "octree down to single points, which other solvers share and `depth` cuts through; or to `depth` alone",
         .choices = {"shared", "to_depth"}},
    };
    return {info, make_solver<Nohd>};
}

}  // namespace hausbench::nohd
