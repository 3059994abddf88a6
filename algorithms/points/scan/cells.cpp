#include "algorithms/points/scan/cells.h"

#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <limits>

namespace hausbench::scan {
namespace {

using Cell = PointCells::Cell;

// Searches the cells for points of B near given points of A, one point of A after the other.
class Searcher {
public:
    Searcher(const PointCells& cells, const NearGrid& grid, const Points& a, const Points& b, CellFindings& findings)
        : cells_(cells), grid_(grid), a_(a), b_(b), findings_(findings) {}

    // Searches for the points of A with rows row_of(0) to row_of(count - 1), in groups of 32. Their cells may be
    // anywhere in memory, so the lists of a group and the first two points of each list are prefetched before the group
    // is searched.
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
    static constexpr std::uint64_t most = 128;  // limit on points of B per point of A; a tree needs fewer
    static constexpr int widest = 16;           // limit on the cells along an axis that one search may visit

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

    // Compares the point of A with the list of points of B that starts at row `first`, and updates the nearest point.
    // Returns true as soon as a point is within the largest distance so far, because the point of A then cannot raise
    // it. If this takes more than `most` comparisons, sets `crowded_` and returns false.
    bool near_enough_in(Index first) {
        const double squared_early_out = findings_.farthest.squared;
        for (Index j = first; j >= 0; j = cells_.next(j)) {
            if (looked_ >= most) {
                crowded_ = WATCHED("scan: cells that are not looked at whole", true);
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

    // Continues the search outside the cell of the point of A: in the six cells that share a face with it, at the
    // candidate of the coarse grid, and in all cells within the largest distance so far. Stops at the first point of B
    // within that distance. If there is none, searches all cells within the distance of the nearest point found. This
    // gives the closest point, and its distance becomes the largest. If too many cells or points are in the way, adds
    // the row to findings.open.
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

    // Examines the cells that may contain a point at less than this squared distance. Returns true as soon as a point
    // is within the largest distance so far. Sets `crowded_` and returns false if there are too many cells or points.
    //
    // The range of cells contains every such point in spite of rounding, because its distance along each axis is at
    // most distance_at_most(t, false), where t is the given squared distance. Proof:
    // Let fl(z) be z rounded, u = 2^-53 the unit roundoff, and m = 2^-1074 the least positive double. Let s < t be the
    // computed squared distance of such a point, x >= 0 its exact distance along an axis, and y its computed distance
    // along this axis, so y >= (1 - u) x. Adding the squares of the other two axes to fl(y^2) does not make it smaller,
    // so s >= fl(y^2).
    //   - If y^2 does not underflow, (1 - u) y^2 <= fl(y^2) <= s < t.
    //   - If y^2 underflows, rounding changes it by at most m / 2, so y^2 <= s + m / 2. Both s and t are multiples of
    //     m, so s <= t - m. Together, y^2 <= t - m / 2 < t. So no slack for underflow is needed: the second argument is
    //     false.
    // In both cases (1 - u) y^2 < t, so x < sqrt(t) / (1 - u)^1.5 < sqrt(t) (1 - u) (1 + 4u). The function
    // distance_at_most() multiplies fl(sqrt(t)) >= sqrt(t) (1 - u) by 1 + 4u and rounds up, so its value exceeds x.
    bool near_enough_within(double squared) {
        const PointCells::Range range =
            cells_.range_of(point_, WATCHED_ELSE("scan: the rounding of the radius that cells are searched in",
                                                 distance_at_most(squared, false), std::sqrt(squared)));
        Cell to;  // the last cells to search; cells beyond them have the same lists as earlier cells of the range
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
    // State of the search for the current point of A.
    const double* point_ = nullptr;
    double squared_ = 0;  // squared distance to the nearest point of B so far
    Index nearest_ = -1;
    std::uint64_t looked_ = 0;  // number of points of B examined
    bool crowded_ = false;      // whether the search was given up because of too many points or cells
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

}  // namespace hausbench::scan
