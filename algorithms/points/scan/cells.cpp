#include "algorithms/points/scan/cells.h"

#include <algorithm>
#include <limits>

namespace hausbench {
namespace {

using Cell = PointCells::Cell;

class Searcher {
public:
    Searcher(const PointCells& cells, const NearGrid& grid, const Points& a, const Points& b, CellFindings& findings)
        : cells_(cells), grid_(grid), a_(a), b_(b), findings_(findings) {}

    // Searches for each row. The points of A are unordered, so the cells of later rows are prefetched while earlier
    // rows are searched.
    template <class RowOf> void search(std::size_t count, const RowOf& row_of) {
        constexpr std::size_t ahead = 32;
        Cell at[ahead];
        Index first[ahead];
        for (std::size_t begin = 0; begin < count; begin += ahead) {
            const std::size_t some = std::min(ahead, count - begin);
            for (std::size_t i = 0; i < some; ++i) {
                at[i] = cells_.cell_of(a_.row(row_of(begin + i)).data());
                __builtin_prefetch(cells_.first_at(at[i]));
            }
            for (std::size_t i = 0; i < some; ++i) {
                first[i] = cells_.first(at[i]);
                if (first[i] >= 0) fetch(first[i]);
            }
            for (std::size_t i = 0; i < some; ++i) {
                const Index second = first[i] >= 0 ? cells_.next(first[i]) : -1;
                if (second >= 0) fetch(second);
            }
            for (std::size_t i = 0; i < some; ++i) search_one(row_of(begin + i), at[i], first[i]);
        }
    }

private:
    static constexpr std::uint64_t most = 128;  // points examined per point of A; beyond this a tree examines fewer
    static constexpr int widest = 16;           // cells along an axis

    void fetch(Index row) const {
        __builtin_prefetch(b_.row(row).data());
        __builtin_prefetch(cells_.next_at(row));
    }

    void search_one(Index row, const Cell& cell, Index first) {
        point_ = a_.row(row).data();
        squared_ = std::numeric_limits<double>::infinity();
        looked_ = 0;
        if (!near_enough_in(first)) search_around(row, cell);
        findings_.counters.point_distances += looked_;
    }

    bool near_enough_in(Index first) {
        const double squared_early_out = findings_.farthest.squared;
        for (Index j = first; j >= 0; j = cells_.next(j)) {
            if (looked_ >= most) {
                crowded_ = true;
                return false;
            }
            ++looked_;
            const double squared = squared_distance(point_, b_.row(j).data());
            if (squared < squared_) {
                squared_ = squared;
                nearest_ = j;
            }
            if (squared <= squared_early_out) return true;
        }
        return false;
    }

    // Searches the cells that share a face; then all cells that may contain a point near enough; then, if there is
    // none, the cells that may contain a point closer than the nearest so far.
    void search_around(Index row, const Cell& cell) {
        constexpr std::int32_t faces[6][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
        for (const auto& [x, y, z] : faces) {
            if (near_enough_in(cells_.first({cell[0] + x, cell[1] + y, cell[2] + z}))) return;
        }
        ++findings_.counters.closest_point_queries;
        const NearGrid::Candidate& candidate = grid_.candidate(point_);
        ++looked_;
        if (const double squared = squared_distance(point_, candidate.point); squared < squared_) {
            squared_ = squared;
            nearest_ = candidate.row;
        }
        const double squared_early_out = std::max(findings_.farthest.squared, 0.0);
        if (squared_ <= squared_early_out) return;
        crowded_ = false;
        looked_ = 0;
        if (near_enough_within(squared_early_out) || (!crowded_ && near_enough_within(squared_))) return;
        if (crowded_)
            findings_.open.push_back(row);
        else
            findings_.farthest = {squared_, row, nearest_};
    }

    // Examines all points at less than this squared distance. Sets `crowded_` if there are too many. Returns whether
    // a point is near enough.
    //
    // Let x be the distance of such a point along an axis, s its computed squared distance, and t the given squared
    // distance; s < t as computed. Then x is at most distance_at_most(t) (kernel/rounding.h), by the relative errors
    // of s and of the root. If squares underflow, no slack is needed: s >= x^2 - (least double) / 2 and s <= t -
    // (least double), so x^2 < t.
    bool near_enough_within(double squared) {
        const PointCells::Range range = cells_.range_of(point_, distance_at_most(squared, false));
        Cell to;  // cells beyond this share the lists of earlier cells
        for (std::size_t k = 0; k < 3; ++k) {
            crowded_ = crowded_ || range.to[k] - range.from[k] >= widest;
            to[k] =
                static_cast<std::int32_t>(std::min<std::int64_t>(range.to[k], range.from[k] + cells_.entries(k) - 1));
        }
        for (std::int32_t z = range.from[2]; z <= to[2] && !crowded_; ++z) {
            for (std::int32_t y = range.from[1]; y <= to[1] && !crowded_; ++y) {
                for (std::int32_t x = range.from[0]; x <= to[0] && !crowded_; ++x) {
                    if (near_enough_in(cells_.first({x, y, z}))) return true;
                }
            }
        }
        return false;
    }

    const PointCells& cells_;
    const NearGrid& grid_;
    const Points &a_, &b_;
    CellFindings& findings_;
    // The point of A whose nearest point is sought.
    const double* point_ = nullptr;
    double squared_ = 0;
    Index nearest_ = -1;
    std::uint64_t looked_ = 0;
    bool crowded_ = false;
};

}  // namespace

void search_cells(const PointCells& cells, const NearGrid& grid, const Points& a, std::span<const Index> rows,
                  const Points& b, CellFindings& findings) {
    Searcher(cells, grid, a, b, findings).search(rows.size(), [&](std::size_t i) { return rows[i]; });
}

void search_cells(const PointCells& cells, const NearGrid& grid, const Points& a, Index begin, Index end,
                  const Points& b, CellFindings& findings) {
    Searcher(cells, grid, a, b, findings).search(static_cast<std::size_t>(end - begin), [&](std::size_t i) {
        return begin + static_cast<Index>(i);
    });
}

}  // namespace hausbench
