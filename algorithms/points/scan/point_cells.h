// Points in small cubes, for sets that lie close together: a near point is then in the same cube or in a neighbouring
// one.
//
// This is a table of lists, small and quick to build, because fresh memory costs more than the work. Cell (x, y, z)
// of the grid uses entry (x mod 2^i, y mod 2^j, z mod 2^k) of the table, so points of any extent need one to two
// entries per point. Distant cells may share an entry: the list of a cell contains all its points, and possibly
// others.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/parallel.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace hausbench {

class PointCells {
public:
    using Cell = std::array<std::int32_t, 3>;

    // Puts the chosen rows of `points` (all if null), which lie in `box`, into cubes of edge 1 / cells_per_length, a
    // positive number. O(n) time, 12 bytes per point. Rows fall along each list, so the lists do not depend on the
    // number of threads.
    PointCells(const Points& points, const std::vector<Index>* chosen, const Box& box, double cells_per_length,
               const Threads& threads);

    // Returns the cell of any point. Monotone in each coordinate.
    Cell cell_of(const double* point) const { return {cell(point[0], 0), cell(point[1], 1), cell(point[2], 2)}; }

    // Returns the range of cell_of(x) for all x with |x - point| <= radius along each axis.
    //
    // Rounding to nearest is monotone and leaves doubles unchanged: if point - radius <= x <= point + radius in exact
    // arithmetic, the same holds for the rounded ends and any double x. So the ends need no slack.
    struct Range {
        Cell from, to;
    };
    Range range_of(const double* point, double radius) const {
        Range range;
        for (std::size_t k = 0; k < 3; ++k) {
            range.from[k] = cell(point[k] - radius, k);
            range.to[k] = cell(point[k] + radius, k);
        }
        return range;
    }

    // Iterate over the list of a cell: row = first(cell); then row = next(row), until it is negative.
    Index first(const Cell& cell) const { return first_[place(cell)]; }
    Index next(Index row) const { return next_[static_cast<std::size_t>(row)]; }

    // Addresses to prefetch.
    const Index* first_at(const Cell& cell) const { return &first_[place(cell)]; }
    const Index* next_at(Index row) const { return &next_[static_cast<std::size_t>(row)]; }

    // Returns the number of entries along an axis; that many neighbouring cells have lists of their own.
    std::int64_t entries(std::size_t axis) const { return std::int64_t{masks_[axis]} + 1; }

private:
    std::int32_t cell(double x, std::size_t k) const {
        constexpr double most = 0x1p29;
        return static_cast<std::int32_t>(std::min(std::max((x - low_[k]) * cells_per_length_, -most), most));
    }
    std::size_t place(const Cell& cell) const {
        const auto part = [&](std::size_t k) {
            return static_cast<std::size_t>(static_cast<std::uint32_t>(cell[k]) & masks_[k]);
        };
        return part(0) | (part(1) << shift_y_) | (part(2) << shift_z_);
    }
    void lay_table(std::size_t count, const Box& box);

    double low_[3];
    double cells_per_length_;
    std::uint32_t masks_[3] = {};
    int shift_y_ = 0, shift_z_ = 0;
    std::vector<Index> first_;
    std::unique_ptr<Index[]> next_;  // by row; not set for rows that were not chosen
};

}  // namespace hausbench
