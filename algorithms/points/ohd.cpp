// OHD: points of A in turn, each by a nearest neighbour search in an octree of B, those that lie near a point of B culled.
//
// Source: Zhang et al. 2017, Algorithms 6 and 7 (Algorithm 6, line 6 forgets the argument Maxlb). The exact distance of a
// random sample of ceil(lambda |A|) points, AHD, is the first lower bound. As printed, the octree has cells of side AHD,
// and a point of A in an occupied cell is culled. That is wrong: two points of such a cell may be sqrt(3) AHD apart. Here a
// point is culled if an occupied cell that holds it has a diagonal of at most the lower bound so far (`culling = exact`).
// `culling = as_printed` keeps the error, so that it can be shown, and is not certified; `ohd_as_printed` is the same under a
// name of its own, for tables.
//
// The octree is built once, down to single points, and cut where cells get as small as the lower bound asks. B stands
// still, so motion does not touch it. O(|A| log |B|) time on tame data, O(|A| + |B|) memory. Budget: points of A.
#include "kernel/deadline.h"
#include "kernel/posed_box.h"
#include "points/exact.h"
#include "points/shuffle.h"
#include "solver.h"

#include <algorithm>
#include <optional>
#include <unordered_set>

namespace hausbench {
namespace {

enum class Culling { exact, none, as_printed };

// The leaf cells of side `side` that hold a point of B, laid from the low corner of B's box.
class OccupiedGrid {
public:
    OccupiedGrid(const Points& b, double side) : low_(box_of(b).low), side_(side) {
        for (Index j = 0; j < b.rows(); ++j) cells_.insert(key(b.row(j)));
    }
    bool holds(const Vec3& p) const { return cells_.contains(key(p)); }

private:
    std::uint64_t key(const Vec3& p) const {
        std::uint64_t key = 0;
        for (int k = 0; k < 3; ++k) {
            const double cell = std::floor((p[k] - low_[k]) / side_);
            const double most = 0x1p20;  // beyond: cells next to the first or last, where no point of B is
            key = (key << 21) | static_cast<std::uint64_t>(std::clamp(cell, -1.0, most) + 1);
        }
        return key;
    }

    Vec3 low_;
    double side_;
    std::unordered_set<std::uint64_t> cells_;
};

class Search {
public:
    Search(const PointOctree& tree, const Points& a, const Points& b, const Query& query)
        : tree_(tree), a_(a), b_(b), query_(query), deadline_(query.time_limit) {}

    Result run(const std::vector<Index>& order, std::size_t samples, Culling culling) {
        std::optional<OccupiedGrid> grid;
        std::uint64_t culled = 0;
        for (std::size_t row = 0; row < order.size(); ++row) {
            Status stopped = Status::converged;
            if (row >= query_.budget) stopped = Status::budget;
            if (row % 64 == 0 && deadline_.passed()) stopped = Status::time_limit;
            if (distance_at_least(farthest_.squared, true) > query_.cutoff) stopped = Status::cutoff_passed;
            if (stopped != Status::converged) {
                return finish(culled, squared_distances_at_most(a_, b_, order.data(), static_cast<Index>(row)),
                              stopped);
            }
            const Index i = order[row];
            const Vec3 point = a_.row(i);
            if (row == samples) {
                squared_resolution_ = farthest_.squared;
                if (culling == Culling::as_printed) make_grid(grid);
            }
            const bool near =
                row >= samples && (culling == Culling::exact ? lies_near(point) : grid && grid->holds(point));
            if (near) {
                ++culled;
            } else {
                look_at(i, point);
            }
        }
        return finish(culled, -1, Status::converged);
    }

private:
    // AHD = 0 gives no octree of that resolution; neither does one of more than 2^20 cells along an axis.
    void make_grid(std::optional<OccupiedGrid>& grid) const {
        const double side = std::sqrt(std::max(farthest_.squared, 0.0));
        const Box& root = tree_.root_cell();
        if (side > 0 && (root.high - root.low).maxCoeff() / side < 0x1p20) grid.emplace(b_, side);
    }

    // Whether some cell holds the point and a point of B, and no two points of it are farther apart, in the rounding of the
    // distances themselves, than the lower bound: then the point cannot be the farthest, or is no farther than the one known.
    bool lies_near(const Vec3& point) {
        if (farthest_.squared <= 0) return false;
        Cursor at = root_of(tree_);
        if ((point.array() < at.cell.low.array()).any() || (point.array() > at.cell.high.array()).any()) return false;
        while (true) {
            ++counters_.node_visits;
            if (squared_distance_at_most(at.cell, at.cell) <= farthest_.squared) return true;
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

    // Algorithm 7, best first. A point is given up at the first distance that is no larger than the lower bound.
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
                    if (squared < nearest) nearest = squared, at = tree_.order()[static_cast<std::size_t>(k)];
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

    Result finish(std::uint64_t culled, double rest, Status stopped) {
        Result result = exact_result(query_, a_, b_, farthest_, counters_, rest, stopped);
        result.extras["culled"] = {static_cast<double>(culled)};
        return result;
    }

    const PointOctree::Node& node(std::int32_t i) const { return tree_.nodes()[static_cast<std::size_t>(i)]; }

    struct Near {
        double squared_lower;
        std::int32_t node;
        bool operator<(const Near& other) const {  // the nearest on top
            return squared_lower != other.squared_lower ? squared_lower > other.squared_lower : node > other.node;
        }
    };

    const PointOctree& tree_;
    const Points &a_, &b_;
    const Query& query_;
    Deadline deadline_;
    Counters counters_;
    FarthestPoint farthest_;
    double squared_resolution_ = -1;  // of AHD, once known
    std::vector<Near> queue_;
};

class Ohd final : public Solver {
public:
    Ohd(const Options& options, Culling culling)
        : culling_(culling),
          lambda_(options.real("lambda")),
          seed_(static_cast<std::uint64_t>(options.integer("seed"))) {}

    Needs needs(const Scene&, const QuerySet&) const override { return {{Structure::point_octree, Side::target}}; }

    void prepare(const Scene& scene, const Prepared& prepared) override {
        scene_ = &scene;
        tree_ = &prepared.point_octree(Side::target);
        Generator random(seed_);
        order_ = order_of(element_count(scene.source), true, random);
    }

    std::size_t prepared_bytes() const override { return order_.capacity() * sizeof(Index); }

    bool certified() const override { return culling_ != Culling::as_printed; }

    Result solve(const Query& query, Trace&) const override {
        const Points a = posed(points_of(scene_->source), query.pose);
        const Points& b = points_of(scene_->target);
        if (out_of_range(a, b)) return {};
        const double samples = std::ceil(lambda_ * static_cast<double>(a.rows()));
        return Search(*tree_, a, b, query).run(order_, static_cast<std::size_t>(samples), culling_);
    }

private:
    Culling culling_;
    double lambda_;
    std::uint64_t seed_;
    const Scene* scene_ = nullptr;
    const PointOctree* tree_ = nullptr;
    std::vector<Index> order_;
};

SolverInfo info_of(const char* name, const char* title) {
    SolverInfo info;
    info.name = name;
    info.title = title;
    info.paper = "zhang2017";
    info.source.points = info.target.points = true;
    info.exact = true;
    info.may_need = {{Structure::point_octree, Side::target}};
    info.parameters = {
        {.name = "lambda",
         .default_value = 0.01,
         .unit = "of |A|",
         .paper_value = "1/100",
         .description = "points of A in the sample that gives the first lower bound",
         .choices = {},
         .least = 0,
         .most = 1},
        {.name = "seed",
         .default_value = std::int64_t{1},
         .unit = "",
         .paper_value = "",
         .description = "of the generator that shuffles A",
         .choices = {},
         .least = 0,
         .most = 9e15},
    };
    return info;
}

}  // namespace

SolverEntry ohd_solver() {
    SolverInfo info = info_of("ohd", "OHD");
    info.certified = true;
    info.parameters.push_back({.name = "culling",
                               .default_value = std::string("exact"),
                               .unit = "",
                               .paper_value = "as_printed",
                               .description =
                                   "leave out points of A in a cell of B whose diagonal is at most the lower bound; "
                                   "as_printed: whose side is, which is wrong, and not certified",
                               .choices = {"exact", "as_printed", "none"}});
    return {info, [](const Options& options) -> std::unique_ptr<Solver> {
                const std::string culling = options.text("culling");
                return std::make_unique<Ohd>(options, culling == "none"    ? Culling::none
                                                      : culling == "exact" ? Culling::exact
                                                                           : Culling::as_printed);
            }};
}

SolverEntry ohd_as_printed_solver() {
    SolverInfo info = info_of("ohd_as_printed", "OHD, as printed");
    info.known_wrong = "the paper culls by cells of side AHD, whose points may be sqrt(3) AHD apart: answers too small";
    return {info, [](const Options& options) -> std::unique_ptr<Solver> {
                return std::make_unique<Ohd>(options, Culling::as_printed);
            }};
}

}  // namespace hausbench
