// Step 5 of scan.cpp: searches for points of B near the points of A. The points of B are stored in small cells
// (point_cells.h).
#pragma once

#include "algorithms/kernel/counters.h"
#include "algorithms/points/exact.h"
#include "algorithms/points/scan/near_grid.h"
#include "algorithms/points/scan/point_cells.h"

#include <span>
#include <vector>

namespace hausbench::scan {

// The results for a block of points of A. Each block has its own results, so that threads can search several blocks at
// the same time.
struct CellFindings {
    // The largest distance so far. Set it to the largest distance known before the search.
    FarthestPoint farthest;
    Counters counters;
    // Rows of A whose search was given up, because too many points or cells are near them. The caller must search for
    // these in another way.
    std::vector<Index> open;
};

// Searches for each of the given rows of A. A row with a point of B within the largest distance so far cannot raise it
// and is done. Otherwise finds the closest point of B, whose distance becomes the largest. Rows for which this takes
// too long are added to findings.open, so the search takes O(1) time per row.
//
// `cells` must contain every point of B that may be closest to one of the rows. `grid` must be a grid over B.
void search_cells(const PointCells& cells, const NearGrid& grid, const Points& a, std::span<const Index> rows,
                  const Points& b, CellFindings& findings);

// Like search_cells() above, but for the rows [begin, end) of A.
void search_cells(const PointCells& cells, const NearGrid& grid, const Points& a, Index begin, Index end,
                  const Points& b, CellFindings& findings);

}  // namespace hausbench::scan
