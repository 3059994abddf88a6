// scan: exact distances of point sets, fast both if a single outlier decides and if the sets are nearly the same.
//
// A point of A is discarded as soon as some point of B is within the largest distance found so far (early breaking,
// Taha and Hanbury 2015). The steps that find such a point go from cheap to expensive; each runs only if the previous
// steps leave points of A undecided:
//   1. A coarse grid over B gives a near point of B, the candidate, for each point of A.
//   2. The points of A with the farthest candidates are compared with all of B, which gives a first largest distance.
//   3. Points of A whose candidate is within this distance are decided.
//   4. Points of B that cannot be nearest to an undecided point are dropped: a grid cell is kept if its distance from
//      such a point is at most the distance of the point's candidate.
//   5. The kept points go into cells about as large as the distance between neighbours. A near point is usually in
//      the cell of the point of A or in an adjacent one; otherwise all cells that may contain one are searched.
//   6. If cells are crowded, their points and the undecided points of A are sorted in Morton order, the former under
//      a tree of boxes. A near leaf of B decides a leaf of A as a whole or point by point; the tree is searched for
//      the remaining points.
// If a sample shows that step 3 would decide few points, step 5 takes all points. Only the grid is built beforehand:
// the structures of steps 5 and 6 depend on the distance and cost less than searching.
//
// Threads take the points of A in blocks (steps 1, 3 and 5). Each block starts from the distance known before the
// round, so the work, the answer and its witness do not depend on the number of threads.
//
// Outliers and clusters: the grid covers the part of B that contains most points, and both sorts refine every crowded
// cell in the frame of its own box (kernel/morton.h), so no step takes its scale from the farthest points.
//
// Exact and certified: only computed squared distances to points of B decide, in the order of operations of
// squared_distance. Boxes are compared with the same monotone operations (kernel/box.h), and cells are rounded
// outward. So the answer has the same bits as the answer of `naive`.
// Time: O(|A| + |B|) if an outlier decides, otherwise about O(|A| log |B| + |B|). Memory: O(|A| + |B|). Budget:
// searches for closest points, checked between batches.
#include "algorithms/kernel/deadline.h"
#include "algorithms/points/point_solver.h"
#include "algorithms/points/scan/near.h"
#include "algorithms/points/scan/near_grid.h"
#include "algorithms/points/scan/passes.h"

#include <algorithm>

namespace hausbench {
namespace {

class Scan final : public Solver {
public:
    explicit Scan(const Options& options)
        : cells_from_(static_cast<double>(options.integer("cells_from"))),
          tree_from_(static_cast<double>(options.integer("tree_from"))) {}

    void prepare(const Scene& scene, const Prepared& prepared) override {
        scene_ = &scene;
        const Points& b = points_of(scene.target);
        target_ = extent_of(b, prepared.threads());
        if (target_.magnitude() > largest_safe_coordinate) return;
        grid_ = NearGrid(b, target_.box, prepared.threads());
    }

    std::size_t prepared_bytes() const override { return grid_.bytes(); }

    Result solve(const Query& query, State*, Trace& trace) const override {
        Points moved;
        if (!query.source_pose.is_identity()) moved = posed(points_of(scene_->source), query.source_pose);
        const Points& a = query.source_pose.is_identity() ? points_of(scene_->source) : moved;
        const Points& b = points_of(scene_->target);
        const Threads threads(query.threads);
        const Extent source = extent_of(a, threads);
        if (std::max(source.magnitude(), target_.magnitude()) > largest_safe_coordinate) return {};

        const Deadline deadline(query.time_limit);
        ScanState state;
        const ScanWork work{query, deadline, threads, a, b, grid_, target_.box, cells_from_, tree_from_};
        Status stopped = work.stop(state);
        double left = -1;  // bounds the squared distances of undecided points of A
        if (stopped != Status::converged) {
            left = squared_distances_at_most(a, b, nullptr, 0);
        } else {
            const std::vector<Undecided> farthest = farthest_of_blocks(work);
            std::vector<Undecided> first = farthest;
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
                if (stopped != Status::converged) left = most_of(undecided);
            }
        }
        return exact_result(query, a, b, state.farthest, state.counters, source.tiny || target_.tiny, left, stopped);
    }

private:
    static constexpr std::size_t batch = 8;  // points compared with all of B in one pass
    static constexpr std::size_t block_rows = ScanWork::block_rows;

    static double most_of(const std::vector<Undecided>& undecided) {
        double most = -1;
        for (const Undecided& one : undecided) most = std::max(most, one.squared);
        return most;
    }

    double squared_to_candidate(const double* point) const {
        return squared_distance(point, grid_.candidate(point).point);
    }

    // Compares the points with the farthest candidates with all of B, which decides them.
    static void compare_farthest(const ScanWork& work, std::vector<Undecided>& undecided, ScanState& state) {
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

    // Replaces candidates by the nearest of some evenly spread points of B: far from B, such a point is about as near
    // as the closest one.
    void compare_with_spread(const ScanWork& work, std::vector<Undecided>& undecided, ScanState& state) const {
        const std::size_t pairs = undecided.size() * grid_.occupied();
        if (undecided.empty() || pairs > 8 * static_cast<std::size_t>(work.b.rows())) return;
        std::vector<Index> rows;
        for (const Undecided& one : undecided) rows.push_back(one.row);
        const std::vector<double> squared = squared_to_nearest(work.a, rows, grid_.spread(), work.threads);
        state.counters.point_distances += pairs;
        for (std::size_t i = 0; i < rows.size(); ++i) undecided[i].squared = std::min(undecided[i].squared, squared[i]);
        drop_decided(undecided, state);
    }

    // Returns the point of each block of A whose candidate is farthest.
    std::vector<Undecided> farthest_of_blocks(const ScanWork& work) const {
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

    // Returns whether most candidates are farther than the largest distance so far.
    bool candidates_decide_few(const Points& a, ScanState& state) const {
        const std::vector<Index> some = sample_of(a, nullptr);
        std::size_t left = 0;
        for (const Index row : some) left += squared_to_candidate(a.row(row).data()) > state.farthest.squared ? 1 : 0;
        state.counters.point_distances += static_cast<std::uint64_t>(a.rows()) + some.size();
        return left > some.size() / 2;
    }

    // Returns the points of A that are not decided by their candidates.
    std::vector<Undecided> keep_undecided(const ScanWork& work, const std::vector<Undecided>& farthest,
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
        // One pass over B for the farthest candidates, then more passes as long as each decides half of the rest or
        // two more would finish, because this is cheaper than cells.
        for (std::size_t before = 2 * undecided.size();
             !undecided.empty() && undecided.size() <= std::max(before / 2, 2 * batch);) {
            before = undecided.size();
            compare_farthest(work, undecided, state);
        }
        return undecided;
    }

    static void drop_decided(std::vector<Undecided>& undecided, const ScanState& state) {
        std::erase_if(undecided, [&](const Undecided& one) { return one.squared <= state.farthest.squared; });
    }

    double cells_from_, tree_from_;
    const Scene* scene_ = nullptr;
    Extent target_;
    NearGrid grid_;
};

}  // namespace

SolverEntry scan_solver() {
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
    };
    return {info, make_solver<Scan>};
}

}  // namespace hausbench
