// scan: exact distances of point sets, for both regimes: one outlier decides, or the sets are nearly the same.
//
// A point of A is given up as soon as some point of B is no farther than the largest distance found so far (early
// breaking, Taha and Hanbury 2015). The steps that find such a point go from cheap to expensive; each is taken only if
// the ones before leave points of A undecided:
//   1. a coarse grid over B gives one near point of B, the candidate, for each point of A;
//   2. the points of A whose candidates are farthest are compared with all of B: the largest distance so far;
//   3. points of A whose candidate is no farther than that are decided;
//   4. of B only what may be nearest to an undecided point is kept: the grid cells no farther from it than its candidate;
//   5. if that is much, it is sorted in Morton order under a tree of boxes, and so are the undecided points of A. A leaf
//      of A is decided by a near leaf of B as a whole, or else point by point: by that leaf, then by a search.
// A tree over all of B is built beforehand only if there are several queries.
//
// Outliers and clusters: the grid covers the part of B where most points are, and both sorts refine every cell that holds
// many points in the frame of its own box (kernel/morton.h), so that no step takes its scale from the farthest points.
//
// Exact and certified: only computed squared distances to points of B, in the order of operations of squared_distance,
// decide; boxes are compared in the same monotone operations (kernel/box.h), and cells are rounded outward. So the answer is
// the same bits as that of `naive`. O(|A| + |B|) where an outlier decides, about O(|A| log |B| + |B|) else; O(|A| + |B|)
// memory. Budget: searches for closest points, looked at between batches.
#include "kernel/deadline.h"
#include "points/scan_search.h"
#include "solver.h"
#include "structures/near_grid.h"
#include "structures/point_blocks.h"

#include <algorithm>
#include <optional>
#include <span>

namespace hausbench {
namespace {

// A point of A that may still be the farthest one, and the squared distance of its candidate.
struct Undecided {
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
        return {need<PointBlocks>(Side::target)};
    }

    void prepare(const Scene& scene, const Prepared& prepared) override {
        scene_ = &scene;
        const Points& b = points_of(scene.target);
        target_ = extent_of(b);
        if (target_.magnitude() > largest_safe_coordinate) return;
        grid_ = NearGrid(b, target_.box);
        if (prepared.has<PointBlocks>(Side::target)) blocks_ = &prepared.get<PointBlocks>(Side::target);
    }

    std::size_t prepared_bytes() const override { return grid_.bytes(); }

    Result solve(const Query& query, State*, Trace&) const override {
        Points moved;
        if (!query.source_pose.is_identity()) moved = posed(points_of(scene_->source), query.source_pose);
        const Points& a = query.source_pose.is_identity() ? points_of(scene_->source) : moved;
        const Points& b = points_of(scene_->target);
        const Extent source = extent_of(a);
        if (std::max(source.magnitude(), target_.magnitude()) > largest_safe_coordinate) return {};

        const Deadline deadline(query.time_limit);
        ScanState state;
        std::vector<Undecided> undecided;
        Status stopped = stop(query, deadline, state);
        double left = -1;  // bounds the squared distances of points of A that were not decided
        if (stopped != Status::converged) {
            left = squared_distances_at_most(a, b, nullptr, 0);
        } else {
            sample(a, b, state);
            undecided = keep_undecided(a, b, state);
            stopped = finish(query, deadline, a, b, undecided, state);
            if (stopped != Status::converged) left = most_of(undecided);
        }
        return exact_result(query, a, b, state.farthest, state.counters, source.tiny || target_.tiny, left, stopped);
    }

private:
    static constexpr std::size_t batch = 8;  // points compared with all of B in one pass over it

    static Status stop(const Query& query, const Deadline& deadline, const ScanState& state) {
        if (state.counters.closest_point_queries >= query.budget) return Status::budget;
        if (distance_at_least(std::max(state.farthest.squared, 0.0), true) > query.cutoff) return Status::above_cutoff;
        return deadline.passed() ? Status::time_limit : Status::converged;
    }

    static double most_of(const std::vector<Undecided>& undecided) {
        double most = -1;
        for (const Undecided& one : undecided) most = std::max(most, one.squared);
        return most;
    }

    double squared_to_candidate(const double* point) const {
        return squared_distance(point, grid_.candidate(point).point);
    }

    // Puts the farthest candidates first, compares their points of A with all of B.
    static void compare_farthest(const Points& a, const Points& b, std::vector<Undecided>& undecided, std::size_t count,
                                 ScanState& state) {
        count = std::min(count, undecided.size());
        const auto farther = [](const Undecided& x, const Undecided& y) {
            return x.squared != y.squared ? x.squared > y.squared : x.row < y.row;
        };
        std::partial_sort(undecided.begin(), undecided.begin() + static_cast<std::ptrdiff_t>(count), undecided.end(),
                          farther);
        std::vector<Index> rows;
        for (std::size_t i = 0; i < count; ++i) rows.push_back(undecided[i].row);
        compare_with_all(a, rows, b, state.farthest, state.counters);
    }

    // A first lower bound.
    void sample(const Points& a, const Points& b, ScanState& state) const {
        constexpr std::int64_t most = 1024;
        const std::int64_t count = std::min<std::int64_t>(a.rows(), most);
        std::vector<Undecided> some;
        for (std::int64_t i = 0; i < count; ++i) {
            const auto row = static_cast<Index>(a.rows() * i / count);
            some.push_back({squared_to_candidate(a.row(row).data()), row});
        }
        state.counters.point_distances += static_cast<std::uint64_t>(count);
        compare_farthest(a, b, some, batch / 2, state);
    }

    // The points of A that their candidate does not decide.
    std::vector<Undecided> keep_undecided(const Points& a, const Points& b, ScanState& state) const {
        std::vector<Undecided> undecided;
        for (Index i = 0; i < a.rows(); ++i) {
            const double squared = squared_to_candidate(a.row(i).data());
            if (squared > state.farthest.squared) undecided.push_back({squared, i});
        }
        state.counters.point_distances += static_cast<std::uint64_t>(a.rows());
        // One pass over B for the farthest candidates, and more while each decides half of what is left: cheaper than a tree.
        for (std::size_t before = 2 * undecided.size(); !undecided.empty() && undecided.size() <= before / 2;) {
            before = undecided.size();
            compare_farthest(a, b, undecided, batch, state);
            drop_decided(undecided, state);
        }
        return undecided;
    }

    static void drop_decided(std::vector<Undecided>& undecided, const ScanState& state) {
        std::erase_if(undecided, [&](const Undecided& one) { return one.squared <= state.farthest.squared; });
    }

    Status finish(const Query& query, const Deadline& deadline, const Points& a, const Points& b,
                  const std::vector<Undecided>& undecided, ScanState& state) const {
        if (undecided.empty()) return Status::converged;
        if (const Status stopped = stop(query, deadline, state); stopped != Status::converged) return stopped;
        std::vector<Index> rows;
        for (const Undecided& one : undecided) rows.push_back(one.row);
        std::sort(rows.begin(), rows.end());
        const auto search_in = [&](const PointBlocks& blocks) {
            const std::vector<Index>* chosen = rows.size() == static_cast<std::size_t>(a.rows()) ? nullptr : &rows;
            return search(query, deadline, leaves_of(a, chosen, blocks.frame), blocks, state);
        };
        if (blocks_) return search_in(*blocks_);

        const std::optional<std::vector<Index>> near = near_undecided(a, b, undecided, state);
        const std::size_t count = near ? near->size() : static_cast<std::size_t>(b.rows());
        if (static_cast<double>(rows.size()) * static_cast<double>(count) < tree_from_) {
            return compare(query, deadline, a, rows, b, near, state);
        }
        return search_in(PointBlocks(b, near ? &*near : nullptr, target_.box));
    }

    // The points of B in cells that the closest points of undecided ones may lie in; none if that would hardly leave any out.
    //
    // A closest point of B is at a computed squared distance of at most that of the candidate, so along each axis its exact
    // distance is at most distance_at_most() of it (kernel/rounding.h).
    std::optional<std::vector<Index>> near_undecided(const Points& a, const Points& b,
                                                     const std::vector<Undecided>& undecided, ScanState& state) const {
        std::vector<std::uint8_t> flags(grid_.cells());
        std::size_t work = 0;
        for (const Undecided& one : undecided) {
            work += 8 + grid_.mark(a.row(one.row).data(), distance_at_most(one.squared, true), flags);
            if (work > static_cast<std::size_t>(b.rows())) return {};
        }
        state.counters.bound_tests += undecided.size();
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

    static Status search(const Query& query, const Deadline& deadline, std::span<const PointLeaf> leaves,
                         const PointBlocks& blocks, ScanState& state) {
        constexpr std::size_t chunk = 64;  // leaves between two looks at the clock
        if (leaves.size() > chunk) search_samples(blocks, leaves, state);
        for (std::size_t begin = 0; begin < leaves.size(); begin += chunk) {
            if (const Status stopped = stop(query, deadline, state); stopped != Status::converged) return stopped;
            search_leaves(blocks, leaves.subspan(begin, std::min(chunk, leaves.size() - begin)), state);
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
    info.ignores_tolerance = true;
    info.may_need = {need<PointBlocks>(Side::target)};
    info.parameters = {
        {.name = "tree_from",
         .default_value = std::int64_t{1} << 17,
         .unit = "pairs",
         .paper_value = "",
         .description = "from this many undecided points of A times points of B near them on, a tree is built",
         .choices = {},
         .least = 0,
         .most = 1e18},
    };
    return {info, [](const Options& options) -> std::unique_ptr<Solver> { return std::make_unique<Scan>(options); }};
}

}  // namespace hausbench
