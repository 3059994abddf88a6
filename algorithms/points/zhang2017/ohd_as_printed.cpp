// OHD as printed, to show the effect of its error: Zhang et al. 2017, Algorithms 6 and 7, sections 4.4.1 and 4.4.2.
//
// AHD is the first lower bound, from a sample of A. The error: a point of A is culled, that is, skipped, if its cell of
// side AHD contains a point of B, although the two points may be sqrt(3) * AHD apart. ohd.cpp has the correction.
//
// As printed, the octree is built for each query, once AHD is known. Its leaves have exactly the side AHD and are used
// for culling and for searching. An octree with such leaves is impossible if AHD = 0, and is not built if it has more
// than 2^40 cells along an axis. Then cells are split down to single points, and no point is culled.
// Time: O(lambda |A| |B|) in the worst case for AHD, then O(|A| log |B|) on typical data. The unit of Query::budget is
// one point of A; the points of the sample count, too.
#include "algorithms/kernel/deadline.h"
#include "algorithms/kernel/posed_box.h"
#include "algorithms/points/point_solver.h"
#include "algorithms/points/zhang2017/octree_cursor.h"
#include "algorithms/points/zhang2017/ohd.h"

#include <optional>
#include <queue>

namespace hausbench::zhang2017 {
namespace {

// The octree of B in the paper (Octree_B). Its leaves are cubes with exactly the given side.
struct CellsOfB {
    CellsOfB(const Points& b, double side) : tree(b, root_of_side(b, side, levels)) {}

    int levels = -1;  // number of halvings from the root to cells of the given side; -1: such cells do not exist
    PointOctree tree;

    bool leaf(const PointOctree::Node& node) const {
        return node.child_count == 0 || (levels >= 0 && node.depth >= levels);
    }

    // Returns whether the leaf-sized cell that contains this point of A also contains a point of B.
    bool occupied_at(const Vec3& point) const {
        Cursor at = root_of(tree);
        if ((point.array() < at.cell.low.array()).any() || (point.array() >= at.cell.high.array()).any()) return false;
        for (int level = 0; level < levels; ++level) {
            const int octant = octant_of(at.cell, point);
            std::optional<Cursor> next;
            for_each_part(tree, at, [&](const Cursor& part) {
                const PointOctree::Node& node = tree.nodes()[static_cast<std::size_t>(part.node)];
                if (octant_of(at.cell, tree.points().row(node.first)) == octant) next = part;
            });
            if (!next) return false;
            at = *next;
        }
        return levels >= 0;
    }

private:
    // Returns a root cell whose side is 2^levels times the given side and longer than the box of B, and sets `levels`.
    // If this takes more than 40 levels, or if the side is 0, returns a cube around B and sets `levels` to -1.
    static Box root_of_side(const Points& b, double side, int& levels) {
        const Box box = box_of(b);
        const double width = (box.high - box.low).maxCoeff();
        constexpr int most = 40;
        int count = 0;
        double root = side;
        while (side > 0 && count <= most && root <= width) {
            root *= 2;
            ++count;
        }
        const bool resolved = side > 0 && count <= most;
        levels = resolved ? count : -1;
        if (!resolved) root = width;
        return {box.low, (box.low + Vec3::Constant(root)).cwiseMax(box.high)};
    }
};

class OhdAsPrinted final : public Solver {
public:
    explicit OhdAsPrinted(const Options& options)
        : lambda_(options.real("lambda")), seed_(static_cast<std::uint64_t>(options.integer("seed"))) {}

    bool certified() const override { return false; }

    void prepare(const Scene& scene, const Prepared&) override {
        scene_ = &scene;
        Generator random(seed_);
        sample_ = first_of_order(element_count(scene.source), lambda_, random);
        target_ = ShuffledTarget(points_of(scene.target), true, random);
    }

    std::size_t prepared_bytes() const override { return sample_.capacity() * sizeof(Index) + target_.bytes(); }

    // Algorithm 6 of the paper.
    Result solve(const Query& query, State*, Trace&) const override;

private:
    double lambda_;
    std::uint64_t seed_;
    const Scene* scene_ = nullptr;
    std::vector<Index> sample_;
    ShuffledTarget target_;
};

// A cell of B in the queue of nn_dist(), and a lower bound on its squared distance to the point of A.
struct NearCell {
    double squared_lower;
    std::int32_t node;
    bool operator<(const NearCell& other) const {  // puts the nearest on top of a heap
        return squared_lower != other.squared_lower ? squared_lower > other.squared_lower : node > other.node;
    }
};

// Algorithm 7 of the paper: finds the nearest point of B to point i of A and updates `farthest`. Stops at the first
// point of B within the lower bound, because point i then cannot raise it.
void nn_dist(const CellsOfB& cells, const Points& a, Index i, FarthestPoint& farthest, Counters& counters) {
    ++counters.closest_point_queries;
    const Vec3 point = a.row(i);
    FarthestPoint nearest{std::numeric_limits<double>::infinity(), i, -1};
    std::priority_queue<NearCell> queue;
    queue.push({0, 0});
    for (; !queue.empty() && queue.top().squared_lower < nearest.squared;) {
        const PointOctree::Node& node = cells.tree.nodes()[static_cast<std::size_t>(queue.top().node)];
        queue.pop();
        if (cells.leaf(node)) {
            for (std::int32_t k = node.first; k < node.first + node.count; ++k) {
                ++counters.point_distances;
                const double squared = squared_distance(point.data(), cells.tree.points().row(k).data());
                if (squared <= farthest.squared) return;
                if (squared < nearest.squared) {
                    nearest.squared = squared;
                    nearest.target = cells.tree.order()[static_cast<std::size_t>(k)];
                }
            }
            continue;
        }
        for (std::int32_t k = node.first_child; k < node.first_child + node.child_count; ++k) {
            ++counters.node_visits;
            const double lower = squared_distance_to_box(point, cells.tree.nodes()[static_cast<std::size_t>(k)].cell);
            if (lower >= nearest.squared) continue;
            ++counters.queue_pushes;
            queue.push({lower, k});
        }
    }
    if (nearest.squared > farthest.squared) farthest = nearest;
}

Result OhdAsPrinted::solve(const Query& query, State*, Trace&) const {
    const Points a = posed(points_of(scene_->source), query.source_pose);
    const Points& b = points_of(scene_->target);
    if (out_of_range(a, b)) return {};
    const Deadline deadline = query.deadline();
    Counters counters;
    FarthestPoint farthest;
    std::uint64_t taken = 0, culled = 0;
    const auto stop = [&](bool look_at_clock) {
        if (distance_at_least(std::max(farthest.squared, 0.0), true) > query.cutoff) return Status::above_cutoff;
        if (look_at_clock && deadline.passed()) return Status::time_limit;
        return taken++ >= query.budget ? Status::budget : Status::converged;
    };
    const auto finish = [&](Index first, Status stopped) {
        const double rest = squared_distances_at_most(a, b, nullptr, first);
        Result result = exact_result(query, a, b, farthest, counters, rest, stopped);
        result.reported["culled"] = static_cast<double>(culled);
        return result;
    };
    for (const Index i : sample_) {
        if (const Status stopped = stop(true); stopped != Status::converged) return finish(0, stopped);
        if (!early_break(a, i, target_, deadline, farthest, counters)) return finish(0, Status::time_limit);
    }
    const CellsOfB cells(b, std::sqrt(std::max(farthest.squared, 0.0)));
    for (Index i = 0; i < a.rows(); ++i) {
        if (const Status stopped = stop(i % 64 == 0); stopped != Status::converged) return finish(i, stopped);
        if (cells.occupied_at(a.row(i))) {
            ++culled;
        } else {
            nn_dist(cells, a, i, farthest, counters);
        }
    }
    return finish(static_cast<Index>(a.rows()), Status::converged);
}

}  // namespace

}  // namespace hausbench::zhang2017

namespace hausbench::ohd_as_printed {

using namespace zhang2017;

SolverEntry solver() {
    SolverInfo info = point_solver_info("ohd_as_printed", "OHD as printed", "zhang2017");
    info.abilities.erase(Ability::traces);
    info.known_wrong = "the paper culls by cells of side AHD, whose points may be sqrt(3) AHD apart: answers too small";
    info.parameters = ohd_parameters();
    return {info, make_solver<OhdAsPrinted>};
}

}  // namespace hausbench::ohd_as_printed
