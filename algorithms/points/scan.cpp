// scan: exact distances of point sets, for both regimes: one outlier decides, or the sets are nearly the same.
//
// A point of A is given up as soon as some point of B is no farther than the largest distance found so far (early
// breaking, Taha and Hanbury 2015). Here the steps that find such a point go from cheap to dear, and each is taken only if
// the ones before have left something to do:
//   1. a coarse grid over B guesses one near point of B for each point of A;
//   2. the points of A whose guesses are farthest are compared with all of B, which gives the largest distance so far;
//   3. points of A whose guess is no farther than that are given up;
//   4. of B only what may be near the rest is kept: grid cells within reach of their guesses;
//   5. if that is much, it is sorted in Morton order under a tree of boxes, the rest of A in the same order, and leaves of
//      A are tried against leaves of B at the same place of the order: first whole leaves, then points, then by a search.
// A tree over all of B is built beforehand only if there are several queries.
//
// Exact and certified: only computed squared distances to points of B, in the order of operations of squared_distance,
// decide; boxes are compared in the same monotone operations (kernel/box.h), and cells are rounded outward. So the answer is
// the same bits as that of `naive`. O(|A| + |B|) where an outlier decides, about O(|A| log |B| + |B|) else; O(|A| + |B|)
// memory. Budget: searches for closest points, looked at between batches.
#include "kernel/deadline.h"
#include "kernel/near_grid.h"
#include "points/scan_search.h"
#include "solver.h"

#include <algorithm>
#include <optional>

namespace hausbench {
namespace {

// A point of A that may still be the farthest one, and the squared distance of its guess.
struct Rest {
    double squared;
    Index row;
};

class Scan final : public Solver {
public:
    explicit Scan(const Options& options) : tree_from_(static_cast<double>(options.integer("tree_from"))) {}

    Needs needs(const Scene& scene, const QuerySet& queries) const override {
        // A target that fits one leaf needs no tree; one query alone builds what it needs of it.
        if (points_of(scene.target).rows() <= static_cast<Eigen::Index>(block_points)) return {};
        if (!queries.moves && queries.count <= 1) return {};
        return {{Structure::point_blocks, Side::target}};
    }

    void prepare(const Scene& scene, const Prepared& prepared) override {
        scene_ = &scene;
        const Points& b = points_of(scene.target);
        target_ = extent_of(b);
        if (target_.magnitude() > largest_safe_coordinate) return;
        grid_ = NearGrid(b, target_.box);
        if (prepared.has(Structure::point_blocks, Side::target)) blocks_ = &prepared.point_blocks(Side::target);
    }

    std::size_t prepared_bytes() const override { return grid_.bytes(); }

    Result solve(const Query& query, Trace&) const override {
        Points moved;
        if (!query.pose.is_identity()) moved = posed(points_of(scene_->source), query.pose);
        const Points& a = query.pose.is_identity() ? points_of(scene_->source) : moved;
        const Points& b = points_of(scene_->target);
        const Extent source = extent_of(a);
        if (std::max(source.magnitude(), target_.magnitude()) > largest_safe_coordinate) return {};

        const Deadline deadline(query.time_limit);
        ScanState state;
        std::vector<Rest> rest;
        Status stopped = stop(query, deadline, state);
        double left = -1;  // bounds the squared distances of points of A that were not decided
        if (stopped != Status::converged) {
            left = squared_distances_at_most(a, b, nullptr, 0);
        } else {
            sample(a, b, state);
            rest = keep_undecided(a, b, state);
            stopped = finish(query, deadline, a, b, rest, state);
            if (stopped != Status::converged) left = most_of(rest);
        }
        return exact_result(query, a, b, state.farthest, state.counters, source.tiny || target_.tiny, left, stopped);
    }

private:
    static constexpr std::size_t batch = 8;  // points compared with all of B in one pass over it

    static Status stop(const Query& query, const Deadline& deadline, const ScanState& state) {
        if (state.counters.closest_point_queries >= query.budget) return Status::budget;
        if (distance_at_least(std::max(state.farthest.squared, 0.0), true) > query.cutoff) return Status::cutoff_passed;
        return deadline.passed() ? Status::time_limit : Status::converged;
    }

    static double most_of(const std::vector<Rest>& rest) {
        double most = -1;
        for (const Rest& one : rest) most = std::max(most, one.squared);
        return most;
    }

    double guess(const double* point) const { return squared_distance(point, grid_.guess(point).point); }

    // Puts the farthest guesses first, compares them with all of B.
    static void raise_by_farthest(const Points& a, const Points& b, std::vector<Rest>& rest, std::size_t count,
                                  ScanState& state) {
        count = std::min(count, rest.size());
        const auto farther = [](const Rest& x, const Rest& y) {
            return x.squared != y.squared ? x.squared > y.squared : x.row < y.row;
        };
        std::partial_sort(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(count), rest.end(), farther);
        std::vector<Index> rows;
        for (std::size_t i = 0; i < count; ++i) rows.push_back(rest[i].row);
        raise_by_scan(a, rows, b, state.farthest, state.counters);
    }

    // A first distance to give up by.
    void sample(const Points& a, const Points& b, ScanState& state) const {
        constexpr std::int64_t most = 1024;
        const std::int64_t count = std::min<std::int64_t>(a.rows(), most);
        std::vector<Rest> some;
        for (std::int64_t i = 0; i < count; ++i) {
            const auto row = static_cast<Index>(a.rows() * i / count);
            some.push_back({guess(a.row(row).data()), row});
        }
        state.counters.point_distances += static_cast<std::uint64_t>(count);
        raise_by_farthest(a, b, some, batch / 2, state);
    }

    // The points of A that their guess does not decide.
    std::vector<Rest> keep_undecided(const Points& a, const Points& b, ScanState& state) const {
        std::vector<Rest> rest;
        for (Index i = 0; i < a.rows(); ++i) {
            const double squared = guess(a.row(i).data());
            if (squared > state.farthest.squared) rest.push_back({squared, i});
        }
        state.counters.point_distances += static_cast<std::uint64_t>(a.rows());
        // One pass over B for the farthest guesses, and more while each decides half of the rest: cheaper than a tree.
        for (std::size_t before = 2 * rest.size(); !rest.empty() && rest.size() <= before / 2;) {
            before = rest.size();
            raise_by_farthest(a, b, rest, batch, state);
            drop_decided(rest, state);
        }
        return rest;
    }

    static void drop_decided(std::vector<Rest>& rest, const ScanState& state) {
        std::erase_if(rest, [&](const Rest& one) { return one.squared <= state.farthest.squared; });
    }

    Status finish(const Query& query, const Deadline& deadline, const Points& a, const Points& b,
                  std::vector<Rest>& rest, ScanState& state) const {
        if (rest.empty()) return Status::converged;
        if (const Status stopped = stop(query, deadline, state); stopped != Status::converged) return stopped;
        std::vector<Index> rows;
        for (const Rest& one : rest) rows.push_back(one.row);
        std::sort(rows.begin(), rows.end());
        if (blocks_) return search(query, deadline, a, rows, *blocks_, state);

        const std::optional<std::vector<Index>> near = within_reach(a, b, rest, state);
        const std::size_t count = near ? near->size() : static_cast<std::size_t>(b.rows());
        if (static_cast<double>(rows.size()) * static_cast<double>(count) < tree_from_) {
            return compare(query, deadline, a, rows, b, near, state);
        }
        return search(query, deadline, a, rows, PointBlocks(b, near ? &*near : nullptr, target_.box), state);
    }

    // The points of B in cells that the closest points of the rest may lie in; none if that would hardly leave any out.
    std::optional<std::vector<Index>> within_reach(const Points& a, const Points& b, const std::vector<Rest>& rest,
                                                   ScanState& state) const {
        std::vector<std::uint8_t> flags(grid_.cells());
        std::size_t work = 0;
        for (const Rest& one : rest) {
            work += 8 + grid_.mark(a.row(one.row).data(), distance_at_most(one.squared, true), flags);
            if (work > static_cast<std::size_t>(b.rows())) return {};
        }
        state.counters.bound_tests += rest.size();
        std::vector<Index> near;
        for (Index j = 0; j < b.rows(); ++j) {
            if (flags[grid_.cell_of(b.row(j).data())]) near.push_back(j);
        }
        return near;
    }

    // Plain early breaking.
    static Status compare(const Query& query, const Deadline& deadline, const Points& a, const std::vector<Index>& rows,
                          const Points& b, const std::optional<std::vector<Index>>& near, ScanState& state) {
        const auto count = near ? static_cast<Index>(near->size()) : static_cast<Index>(b.rows());
        for (const Index i : rows) {
            if (const Status stopped = stop(query, deadline, state); stopped != Status::converged) return stopped;
            FarthestPoint nearest{std::numeric_limits<double>::infinity(), i, -1};
            ++state.counters.closest_point_queries;
            for (Index n = 0; n < count && nearest.squared > state.farthest.squared; ++n) {
                const Index j = near ? (*near)[static_cast<std::size_t>(n)] : n;
                const double squared = squared_distance(a.row(i).data(), b.row(j).data());
                ++state.counters.point_distances;
                if (squared < nearest.squared) nearest.squared = squared, nearest.target = j;
            }
            if (nearest.squared > state.farthest.squared) state.farthest = nearest;
        }
        return Status::converged;
    }

    static Status search(const Query& query, const Deadline& deadline, const Points& a, const std::vector<Index>& rows,
                         const PointBlocks& blocks, ScanState& state) {
        constexpr std::size_t chunk = 64;  // leaves between two looks at the clock
        const PointLeaves leaves(a, rows.size() == static_cast<std::size_t>(a.rows()) ? nullptr : &rows, blocks.frame,
                                 false);
        const std::size_t count = leaves.leaves.size();
        if (count > chunk) raise_by_samples(blocks, leaves, state);
        for (std::size_t begin = 0; begin < count; begin += chunk) {
            if (const Status stopped = stop(query, deadline, state); stopped != Status::converged) return stopped;
            raise_by_leaves(blocks, leaves, begin, std::min(begin + chunk, count), state);
        }
        return Status::converged;
    }

    double tree_from_;
    const Scene* scene_ = nullptr;
    Extent target_;
    NearGrid grid_;
    const PointBlocks* blocks_ = nullptr;
};

}  // namespace

SolverEntry scan_solver() {
    SolverInfo info;
    info.name = "scan";
    info.title = "scan (ours)";
    info.source.points = info.target.points = true;
    info.certified = true;
    info.exact = true;
    info.may_need = {{Structure::point_blocks, Side::target}};
    info.parameters = {
        {.name = "tree_from",
         .default_value = std::int64_t{1} << 17,
         .unit = "pairs",
         .paper_value = "",
         .description = "undecided points of A times points of B in their reach from which on a tree is built",
         .choices = {},
         .least = 0,
         .most = 1e18},
    };
    return {info, [](const Options& options) -> std::unique_ptr<Solver> { return std::make_unique<Scan>(options); }};
}

}  // namespace hausbench
