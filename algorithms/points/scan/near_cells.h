// Cell numbers of many points in a grid, with vector instructions chosen at run time. The results are the same on
// every target.
#pragma once

#include "algorithms/kernel/box.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace hausbench {

// A grid of cubes that starts at `low`, with size[k] cubes along axis k, ordered by x, then y, then z. A point
// outside belongs to the nearest cell along each axis. Cell numbers are monotone in each coordinate.
struct CellLayout {
    double low[3] = {}, last[3] = {};  // `last` is size - 1
    double cells_per_length = 0;
    std::int32_t size[3] = {1, 1, 1};

    std::int32_t along(double x, int k) const {
        const double scaled = (x - low[k]) * cells_per_length;
        return static_cast<std::int32_t>(std::min(std::max(scaled, 0.0), last[k]));
    }
    std::int32_t cell_of(const double* point) const {
        return along(point[0], 0) + size[0] * (along(point[1], 1) + size[1] * along(point[2], 2));
    }
};

// Writes layout.cell_of(point) for `count` points, three coordinates each, to cells[0..].
void cells_of(const CellLayout& layout, const double* points, std::size_t count, std::int32_t* cells);

// Writes the squared distance, as squared_distance() computes it, from each of `count` points to the point stored for
// its cell, whose coordinates start at of_cells[4 cell]. Returns the number of the farthest point, the first of
// equals; count > 0.
std::size_t squared_to_cells(const CellLayout& layout, const double* of_cells, const double* points, std::size_t count,
                             double* squared);

}  // namespace hausbench
