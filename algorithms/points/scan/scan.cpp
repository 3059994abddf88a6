// scan: exact distances of point sets, fast both if a single outlier decides and if the sets are nearly the same.
//
// A point of A is *decided* once it cannot raise the largest distance found so far: either some point of B is within
// that distance of it (early breaking, Taha and Hanbury 2015), or its closest point of B is known and its distance
// counted. The steps go from cheap to expensive; each runs only if points of A are still undecided:
//   1. A coarse grid over B stores a point of B for each cell. The point stored for the cell of a point of A is its
//      *candidate*. The distance to the candidate is an upper bound.
//   2. The 8 points of A that are farthest from their candidates are compared with all of B, which gives the first
//      largest distance.
//   3. Points of A whose candidate is within the largest distance are decided.
//   4. For each undecided point of A, the grid cells within the distance to its candidate are marked. Points of B in
//      other cells cannot be closest to an undecided point and are left out.
//   5. The other points of B are put into cubes about as large as the distance between neighbours. A point of B near
//      enough is usually in the cube of the point of A or in one that shares a face with it; otherwise all cubes that
//      may contain the closest point are searched.
//   6. If many points of B share a cube, these points and the undecided points of A are sorted in Morton order and cut
//      into leaves of 16, with a tree of boxes over the leaves of B. A leaf of A is compared with one or two near
//      leaves of B, first as a whole, then point by point; then the tree is searched. If a sample shows that step 3
//      would decide fewer than half of the points, steps 3 and 4 are skipped. Only the grid is built in advance: the
//      structures of steps 5 and 6 depend on the largest distance, and building them costs less than searching.
//
// Threads share the points of A in steps 1 and 5, and the points of B in steps 2 and 3. Small point sets are left to one
// thread, because starting another takes longer than it saves. In step 5 each block of points of A starts from the
// largest distance known before its round of 64 blocks, so the work, the answer and its witness do not depend on the
// number of threads.
//
// Outliers do not slow it down: the grid covers only the part of B that contains most points, and crowded cells are
// sorted again in a smaller Morton frame (kernel/morton.h).
//
// The answer is exact and certified, and it has the same bits as the answer of `naive`: only squared distances to
// points of B decide, computed with the operations of squared_distance() in the same order. Distances to boxes are
// computed with the same monotone operations, so a box is never farther than a point in it (kernel/box.h). The radii in
// which cells are searched are rounded up.
//
// Time: O(|A| + |B|) if an outlier decides, otherwise about O(|A| log |B| + |B|). Memory: O(|A| + |B|). The unit of
// Query::budget is one search for a closest point; the budget is checked only between batches of searches.
#include "algorithms/kernel/deadline.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/points/point_solver.h"
#include "algorithms/points/scan/near.h"
#include "algorithms/points/scan/near_grid.h"
#include "algorithms/points/scan/passes.h"

#include <algorithm>

namespace hausbench::scan {
namespace {

class Scan final : public Solver {
public:
    explicit Scan(const Options& options)
        : cells_from_(static_cast<double>(options.integer("cells_from"))),
          tree_from_(static_cast<double>(options.integer("tree_from"))),
          threads_from_(static_cast<double>(options.integer("threads_from"))) {}

    void prepare(const Scene& scene, const Prepared& prepared) override {
        scene_ = &scene;
        const Points& b = points_of(scene.target);
        const Threads threads = threads_of(prepared.threads().most());
        target_ = extent_of(b, threads);
        if (target_.magnitude() > largest_safe_coordinate) return;
        grid_ = NearGrid(b, target_.box, threads);
    }

    std::size_t prepared_bytes() const override { return grid_.bytes(); }

    Result solve(const Query& query, State*, Trace& trace) const override {
        Points moved;
        if (!query.source_pose.is_identity()) moved = posed(points_of(scene_->source), query.source_pose);
        const Points& a = query.source_pose.is_identity() ? points_of(scene_->source) : moved;
        const Points& b = points_of(scene_->target);
        const Threads threads = threads_of(query.threads);
        const Extent source = extent_of(a, threads);
        if (std::max(source.magnitude(), target_.magnitude()) > largest_safe_coordinate) return {};

        const Deadline deadline = query.deadline();
        ScanState state;
        const Work work{query, deadline, threads, a, b, grid_, target_.box, cells_from_, tree_from_};
        Status stopped = work.stop(state);
        double left = -1;  // upper bound on the squared distances of the undecided points of A; -1: all are decided
        if (stopped != Status::converged) {
            left = squared_distances_at_most(a, b, nullptr, 0);
        } else {
            const std::vector<Undecided> farthest = farthest_of_blocks(work);
            std::vector<Undecided> first = farthest;  // a copy, because compare_farthest() erases points
            record(trace, -1, most_of(farthest));
            compare_farthest(work, first, state);
            record(trace, state.farthest.squared, most_of(farthest));
            if (candidates_decide_few(a, state)) {
                stopped = search_all(work, state);
                if (stopped != Status::converged) left = most_of(farthest);
            } else {
                const std::vector<Undecided> undecided = keep_undecided(work, farthest, state);
                record(trace, state.farthest.squared, most_of(undecided));
                stopped = search_undecided(work, undecided, state);
                if (stopped != Status::converged)
                    left = WATCHED("scan: the points that it leaves undecided", most_of(undecided));
            }
        }
        return exact_result(query, a, b, state.farthest, state.counters, source.tiny || target_.tiny, left, stopped);
    }

private:
    static constexpr std::size_t batch = 8;  // points compared with all of B in one pass
    static constexpr std::size_t block_rows = Work::block_rows;

    // Returns at most `most` threads; a single one if there are few points.
    Threads threads_of(int most) const {
        const auto points = points_of(scene_->source).rows() + points_of(scene_->target).rows();
        return Threads(WATCHED("scan: few points start threads", static_cast<double>(points) < threads_from_)
                           ? 1
                           : WATCHED_ELSE("scan: one thread, whatever the number of points", most, 1));
    }

    // Returns the largest squared distance, or -1 if there is none.
    static double most_of(const std::vector<Undecided>& undecided) {
        double most = -1;
        for (const Undecided& point : undecided) most = std::max(most, point.squared);
        return most;
    }

    double squared_to_candidate(const double* point) const {
        return squared_distance(point, grid_.candidate(point).point);
    }

    // Compares the `batch` points that are farthest from their candidates (all points if there are fewer) with all of
    // B. Removes them from `undecided`. Also removes each point that has a known point of B within the new largest
    // distance.
    static void compare_farthest(const Work& work, std::vector<Undecided>& undecided, ScanState& state) {
        const std::size_t count = std::min(batch, undecided.size());
        const auto farther = [](const Undecided& x, const Undecided& y) {
            return x.squared != y.squared ? x.squared > y.squared : x.row < y.row;
        };
        const auto end = undecided.begin() + static_cast<std::ptrdiff_t>(count);
        std::partial_sort(undecided.begin(), end, undecided.end(), farther);
        std::vector<Index> rows;
        for (std::size_t i = 0; i < count; ++i) rows.push_back(undecided[i].row);
        compare_with_all(work.a, rows, work.b, work.threads, state.farthest, state.counters);
        undecided.erase(undecided.begin(), end);
        drop_decided(undecided, state);
    }

    // Lowers the known distances of undecided points: compares each with one point of B from every occupied cell of the
    // grid. For points of A far from B, the nearest of these is about as near as the closest point of B. Does nothing
    // if this takes more than 8 * |B| comparisons.
    void compare_with_spread(const Work& work, std::vector<Undecided>& undecided, ScanState& state) const {
        const std::size_t pairs = undecided.size() * grid_.occupied();
        if (undecided.empty() || pairs > 8 * static_cast<std::size_t>(work.b.rows())) return;
        std::vector<Index> rows;
        for (const Undecided& point : undecided) rows.push_back(point.row);
        const std::vector<double> squared = squared_to_nearest(work.a, rows, grid_.spread(), work.threads);
        state.counters.point_distances += pairs;
        for (std::size_t i = 0; i < rows.size(); ++i) undecided[i].squared = std::min(undecided[i].squared, squared[i]);
        drop_decided(undecided, state);
    }

    // Returns, for each block of block_rows points of A, the point that is farthest from its candidate.
    std::vector<Undecided> farthest_of_blocks(const Work& work) const {
        const auto count = static_cast<std::size_t>(work.a.rows());
        std::vector<Undecided> farthest((count + block_rows - 1) / block_rows);
        work.threads.for_each(farthest.size(), [&](std::size_t block) {
            const std::size_t begin = block * block_rows, some = std::min(block_rows, count - begin);
            double squared[block_rows];
            const std::size_t most = grid_.squared_to_candidates(work.a.data() + 3 * begin, some, squared);
            farthest[block] = {squared[most], static_cast<Index>(begin + most)};
        });
        return farthest;
    }

    // Returns whether most points in a sample of A are farther from their candidates than the largest distance so far.
    // Step 3 would then discard too few points to be worth its time.
    bool candidates_decide_few(const Points& a, ScanState& state) const {
        const std::vector<Index> some = sample_of(a, nullptr);
        std::size_t left = 0;
        for (const Index row : some) left += squared_to_candidate(a.row(row).data()) > state.farthest.squared ? 1 : 0;
        state.counters.point_distances += static_cast<std::uint64_t>(a.rows()) + some.size();
        return left > some.size() / 2;
    }

    // Step 3: returns the points of A that may still raise the largest distance. `farthest` is the result of
    // farthest_of_blocks().
    std::vector<Undecided> keep_undecided(const Work& work, const std::vector<Undecided>& farthest,
                                          ScanState& state) const {
        const auto count = static_cast<std::size_t>(work.a.rows());
        std::vector<Undecided> undecided;
        for (std::size_t block = 0; block < farthest.size(); ++block) {
            if (farthest[block].squared <= state.farthest.squared) continue;
            const std::size_t begin = block * block_rows, some = std::min(block_rows, count - begin);
            double squared[block_rows];
            grid_.squared_to_candidates(work.a.data() + 3 * begin, some, squared);
            state.counters.point_distances += some;
            for (std::size_t i = 0; i < some; ++i) {
                if (squared[i] > state.farthest.squared)
                    undecided.push_back({squared[i], static_cast<Index>(begin + i)});
            }
        }
        compare_with_spread(work, undecided, state);
        // Compares the farthest points with all of B once. Goes on while the last pass removed at least half of the
        // points, or if two more passes are enough for the rest: these passes are cheaper than step 5.
        for (std::size_t before = 2 * undecided.size();
             !undecided.empty() && undecided.size() <= std::max(before / 2, 2 * batch);) {
            before = undecided.size();
            compare_farthest(work, undecided, state);
        }
        return undecided;
    }

    // Removes the points that cannot raise the largest distance, because a known point of B is within it.
    static void drop_decided(std::vector<Undecided>& undecided, const ScanState& state) {
        std::erase_if(undecided, [&](const Undecided& point) { return point.squared <= state.farthest.squared; });
    }

    double cells_from_, tree_from_, threads_from_;
    const Scene* scene_ = nullptr;
    Extent target_;
    NearGrid grid_;
};

}  // namespace

SolverEntry solver() {
    SolverInfo info = point_solver_info("scan", "scan (ours)", "");
    info.certified = true;
    info.abilities.insert(Ability::threads);
    info.parameters = {
        {.name = "cells_from",
         .default_value = std::int64_t{1} << 17,
         .unit = "pairs",
         .description = "sort points into cells from this many undecided points of A times points of B near them",
         .least = 0,
         .most = 1e18},
        {.name = "tree_from",
         .default_value = std::int64_t{1} << 17,
         .unit = "pairs",
         .description = "build a tree from this many pairs that the cells leave undecided",
         .least = 0,
         .most = 1e18},
        {.name = "threads_from",
         .default_value = std::int64_t{1} << 18,
         .unit = "points",
         .description = "use several threads from this many points of A and B together",
         .least = 0,
         .most = 1e18},
    };
    return {info, make_solver<Scan>};
}

}  // namespace hausbench::scan
