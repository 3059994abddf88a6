// Points of a set in small cubes, the cells of an unbounded grid. If two sets lie close together, a near point is
// usually in the same cell or in a neighbouring one.
//
// The cells are stored in a table, each entry of which is a list of points. The table is kept small, because the first
// access to newly allocated memory costs more than the rest of the work. It has 2^i * 2^j * 2^k entries, fewer than
// four per point; cell (x, y, z) of the grid uses the entry (x mod 2^i, y mod 2^j, z mod 2^k). So cells far from each
// other may share an entry: the list of a cell contains all points in the cell, and possibly points of other cells.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/parallel.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace hausbench::scan {

class PointCells {
public:
    using Cell = std::array<std::int32_t, 3>;  // numbers of the cell along x, y and z; may be negative

    // Puts the chosen rows of `points` (all if null) into cubes with the edge 1 / cells_per_length, which must be
    // positive. `box` must contain the points. Takes O(n) time, 4 bytes for each row of `points` and up to 16 bytes for
    // each chosen row. Each list has the chosen rows in reverse order, whatever the number of threads.
    PointCells(const Points& points, const std::vector<Index>* chosen, const Box& box, double cells_per_length,
               const Threads& threads);

    // Returns the cell that contains a point. The grid has no bounds, so the point may be outside the box. The cell
    // numbers never decrease as the coordinates increase.
    Cell cell_of(const double* point) const { return {cell(point[0], 0), cell(point[1], 1), cell(point[2], 2)}; }

    // The cells between `from` and `to` along each axis. range_of() returns a range that contains cell_of(x) for every
    // x with |x - point| <= radius along each axis. It need not be widened for rounding, because cell_of() is monotone:
    // NearGrid::mark() in near_grid.cpp has the proof.
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

    // The list of a cell: starts at row = first(cell), goes on with row = next(row), and ends at a negative row.
    Index first(const Cell& cell) const { return first_[place(cell)]; }
    Index next(Index row) const { return next_[static_cast<std::size_t>(row)]; }

    // Return the addresses that first() and next() read, for prefetching.
    const Index* first_at(const Cell& cell) const { return &first_[place(cell)]; }
    const Index* next_at(Index row) const { return &next_[static_cast<std::size_t>(row)]; }

    // Returns the number of entries of the table along an axis. Up to this many successive cells have different
    // entries.
    std::int64_t entries(std::size_t axis) const { return std::int64_t{masks_[axis]} + 1; }

private:
    std::int32_t cell(double x, std::size_t k) const {
        constexpr double most = 0x1p29;  // so that differences of cell numbers fit into 32 bits
        return static_cast<std::int32_t>(std::min(std::max((x - low_[k]) * cells_per_length_, -most), most));
    }
    // Returns the index in first_ of the entry that a cell uses.
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
    std::vector<Index> first_;       // the table: the first row of each list, or -1
    std::unique_ptr<Index[]> next_;  // for each row: the next row in its list, or -1; not set for rows not chosen
};

}  // namespace hausbench::scan
