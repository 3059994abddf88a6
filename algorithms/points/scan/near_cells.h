// The cells of many points in a grid, computed with vector instructions that are chosen at run time. The results are
// the same whichever instructions run.
#pragma once

#include "algorithms/kernel/box.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace hausbench {

// A grid of size[0] x size[1] x size[2] cubes with its lowest corner at `low`. Cells are numbered along x first, then
// y, then z. A point outside the grid counts as in the nearest cell: its position along each axis is clamped. The
// position never decreases as the coordinate increases.
struct CellLayout {
    double low[3] = {}, last[3] = {};  // `last` is size - 1
    double cells_per_length = 0;       // 1 / edge of a cube
    std::int32_t size[3] = {1, 1, 1};

    // Returns the position along axis k of the cells that contain the coordinate x.
    std::int32_t along(double x, int k) const {
        const double scaled = (x - low[k]) * cells_per_length;
        return static_cast<std::int32_t>(std::min(std::max(scaled, 0.0), last[k]));
    }
    // Returns the number of the cell that contains a point.
    std::int32_t cell_of(const double* point) const {
        return along(point[0], 0) + size[0] * (along(point[1], 1) + size[1] * along(point[2], 2));
    }
};

// Writes layout.cell_of(point) for `count` points, three coordinates each, to cells[0..].
void cells_of(const CellLayout& layout, const double* points, std::size_t count, std::int32_t* cells);

// Computes the squared distance of each of `count` > 0 points to the point stored for its cell, and writes it to
// squared[0..]. The result has the same bits as with squared_distance(). The coordinates of the point stored for a cell
// are of_cells[4 * cell] and the two numbers after it. Returns the number of the point with the largest distance; if
// there are several, the first.
std::size_t squared_to_cells(const CellLayout& layout, const double* of_cells, const double* points, std::size_t count,
                             double* squared);

}  // namespace hausbench
