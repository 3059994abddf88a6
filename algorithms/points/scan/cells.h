// Searches small cells with the points of B (point_cells.h) for points near the points of A: step 5 of scan.cpp.
#pragma once

#include "algorithms/kernel/counters.h"
#include "algorithms/points/exact.h"
#include "algorithms/points/scan/near_grid.h"
#include "algorithms/points/scan/point_cells.h"

#include <span>
#include <vector>

namespace hausbench {

// The results for some points of A. Each block of points has results of its own, so that several threads can search
// blocks at the same time.
struct CellFindings {
    // The largest distance so far. The caller sets it to the largest distance known before the search.
    FarthestPoint farthest;
    Counters counters;
    // Rows of A that stay undecided because too many points or cells are near them. The caller must search for these in
    // another way.
    std::vector<Index> open;
};

// Decides each of the given rows of A: finds a point of B within the largest distance so far or, if B has no such
// point, finds the closest point, whose distance then becomes the largest. Rows for which this takes too long are added
// to findings.open instead, so the search takes O(1) time per row. `cells` must contain every point of B that may be
// closest to one of the rows. `grid` is over B, and gives one near point of B for each row.
void search_cells(const PointCells& cells, const NearGrid& grid, const Points& a, std::span<const Index> rows,
                  const Points& b, CellFindings& findings);

// Does the same for the rows [begin, end).
void search_cells(const PointCells& cells, const NearGrid& grid, const Points& a, Index begin, Index end,
                  const Points& b, CellFindings& findings);

}  // namespace hausbench
