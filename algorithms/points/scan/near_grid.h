// A coarse grid over a point set. Each cell stores one point of the set, its *candidate*: a quick guess at the closest
// point for any query point in the cell. It lies in the cell or, if the cell is empty, in an occupied cell nearby. It
// need not be the closest point, but its distance is an upper bound on the distance to the set.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/parallel.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/points/scan/near_cells.h"

#include <cstdint>
#include <vector>

namespace hausbench::scan {

class NearGrid {
public:
    struct Candidate {
        double point[3];
        Index row;  // its row in the set
    };

    NearGrid() = default;

    // Builds a grid of about n / 8 cells, at most 2^16, over n points with the bounding box `box`. The grid covers only
    // the part of the box that contains most points, so that a few outliers do not make its cells large. O(n) time.
    NearGrid(const Points& points, const Box& box, const Threads& threads = Threads());

    // Returns the number of the cell that contains a point, or of the nearest cell if the point is outside the grid.
    std::size_t cell_of(const double* point) const { return static_cast<std::size_t>(layout_.cell_of(point)); }
    const Candidate& candidate(const double* point) const { return candidates_[cell_of(point)]; }

    // Writes the squared distance from each of `count` > 0 points to the candidate of its cell to `squared`. Returns
    // the index of the point with the largest distance. The parameters are as for squared_to_cells() (near_cells.h).
    std::size_t squared_to_candidates(const double* points, std::size_t count, double* squared) const;

    // Sets flags[cell] to 1 for each cell that may contain a point x with |x - point| <= radius along each axis.
    // Returns the number of these cells.
    std::size_t mark(const double* point, double radius, std::vector<std::uint8_t>& flags) const;

    // Cells per unit of length, the same along each axis; 0 if there is only one cell.
    double cells_per_length() const { return layout_.cells_per_length; }

    std::size_t occupied() const { return occupied_; }  // the number of cells that contain points

    // Returns one point from each occupied cell. These points are spread evenly in space, even if the density of the set
    // varies.
    Points spread() const;

    // Like mark(), but for the cells that may contain a point whose computed squared distance to `point` is at most
    // `squared`. distance_at_most() (kernel/rounding.h) bounds the exact distance of such a point, and so its distance
    // along each axis.
    std::size_t mark_within(const double* point, double squared, std::vector<std::uint8_t>& flags) const {
        return mark(
            point,
            WATCHED_ELSE(
                "scan: the rounding of the radius that cells are marked by",
                distance_at_most(squared, WATCHED("scan: the underflow of the radius that cells are marked by", true)),
                std::sqrt(squared)),
            flags);
    }

    std::size_t cells() const { return candidates_.size(); }
    std::size_t bytes() const { return candidates_.capacity() * sizeof(Candidate); }

private:
    void lay_cells(const Box& box, double most);
    void take_last_of_each(const Points& points, const Box* inside, const Threads& threads);
    void fill_empty_cells();

    CellLayout layout_;
    std::size_t occupied_ = 0;
    std::vector<Candidate> candidates_;
};

}  // namespace hausbench::scan
