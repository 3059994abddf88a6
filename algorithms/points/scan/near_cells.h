// Computes the grid cells of many points with vector instructions that are chosen at run time. The results are the same
// whichever instructions run.
#pragma once

#include "algorithms/kernel/box.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace hausbench::scan {

// A grid of size[0] x size[1] x size[2] cubes with its lowest corner at `low`. Cells are numbered along x first, then
// y, then z. A point outside the grid belongs to the nearest cell, because its index along each axis is clamped.
struct CellLayout {
    double low[3] = {}, last[3] = {};  // `last` is size - 1
    double cells_per_length = 0;       // 1 / edge of a cube
    std::int32_t size[3] = {1, 1, 1};

    // Returns the index along axis k of the cells that contain the coordinate x. The index never decreases as x
    // increases.
    std::int32_t along(double x, int k) const {
        const double scaled = (x - low[k]) * cells_per_length;
        return static_cast<std::int32_t>(std::min(std::max(scaled, 0.0), last[k]));
    }
    std::int32_t cell_of(const double* point) const {
        return along(point[0], 0) + size[0] * (along(point[1], 1) + size[1] * along(point[2], 2));
    }
};

// Writes layout.cell_of() of each of `count` points to `cells`. `points` has three coordinates for each point.
void cells_of(const CellLayout& layout, const double* points, std::size_t count, std::int32_t* cells);

// Writes the squared distance from each of `count` > 0 points to the point stored for its cell to `squared`, with the
// same bits as squared_distance(). `points` has three coordinates for each point. The point stored for a cell has the
// coordinates of_cells[4 * cell] and the two numbers after it. Returns the index of the point with the largest
// distance, the first one if there are several.
std::size_t squared_to_cells(const CellLayout& layout, const double* of_cells, const double* points, std::size_t count,
                             double* squared);

}  // namespace hausbench::scan
