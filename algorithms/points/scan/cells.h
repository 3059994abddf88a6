// Points of A against the cells of B.
#pragma once

#include "algorithms/kernel/counters.h"
#include "algorithms/points/exact.h"
#include "algorithms/points/scan/near_grid.h"
#include "algorithms/points/scan/point_cells.h"

#include <span>
#include <vector>

namespace hausbench {

// What some points of A tell. A block of points has one of its own, so that blocks can be searched at the same time.
struct CellFindings {
    FarthestPoint farthest;  // among rows with a known closest point; starts as given
    Counters counters;
    // Rows of A that the cells do not decide, because too many points or cells are near them.
    std::vector<Index> open;
};

// For each row of A: a point of B within the squared distance of the farthest so far; where there is none, the closest one. The cells
// have all points of B that may be closest; the grid has one near each point. O(1) for each row.
void search_cells(const PointCells& cells, const NearGrid& grid, const Points& a, std::span<const Index> rows,
                  const Points& b, CellFindings& findings);

// The same for the rows from `begin` to before `end`.
void search_cells(const PointCells& cells, const NearGrid& grid, const Points& a, Index begin, Index end,
                  const Points& b, CellFindings& findings);

}  // namespace hausbench
