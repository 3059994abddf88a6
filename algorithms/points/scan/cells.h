// Searches the cells of B for points near those of A.
#pragma once

#include "algorithms/kernel/counters.h"
#include "algorithms/points/exact.h"
#include "algorithms/points/scan/near_grid.h"
#include "algorithms/points/scan/point_cells.h"

#include <span>
#include <vector>

namespace hausbench {

// Findings about some points of A. Each block of points has its own, so that blocks can be searched at the same time.
struct CellFindings {
    FarthestPoint farthest;  // among rows with a known closest point; starts as given
    Counters counters;
    // Rows of A that stay undecided because too many points or cells are near them.
    std::vector<Index> open;
};

// Finds for each row of A a point of B within the largest squared distance so far or, if there is none, the closest
// point. The cells must contain every point of B that may be closest. The grid gives one near point. O(1) per row.
void search_cells(const PointCells& cells, const NearGrid& grid, const Points& a, std::span<const Index> rows,
                  const Points& b, CellFindings& findings);

// Does the same for the rows [begin, end).
void search_cells(const PointCells& cells, const NearGrid& grid, const Points& a, Index begin, Index end,
                  const Points& b, CellFindings& findings);

}  // namespace hausbench
