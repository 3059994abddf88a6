// A coarse grid over a point set that stores one point in or near each cell: a cheap first candidate for the closest
// point.
//
// It takes one pass over the points, and three sweeps that carry the nearest occupied cell into empty ones.
// Candidates need not be the closest points, but they belong to the set, so their distances are upper bounds.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/parallel.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/points/scan/near_cells.h"

#include <cstdint>
#include <vector>

namespace hausbench {

class NearGrid {
public:
    struct Candidate {
        double point[3];
        Index row;
    };

    NearGrid() = default;

    // `box` is the box of `points`. The grid covers the part of it that contains most points, so that a few outliers
    // do not make its cells large. It has about an eighth as many cells as points, at most 2^16. O(n + cells).
    NearGrid(const Points& points, const Box& box, const Threads& threads = Threads());

    // Returns the cell of a point. A point outside belongs to the nearest cell along each axis. Monotone in each
    // coordinate.
    std::size_t cell_of(const double* point) const { return static_cast<std::size_t>(layout_.cell_of(point)); }
    const Candidate& candidate(const double* point) const { return candidates_[cell_of(point)]; }

    // Writes the squared distance, as squared_distance() computes it, from each of many points (three coordinates
    // each) to its candidate. Returns the number of the farthest point, the first of equals.
    std::size_t squared_to_candidates(const double* points, std::size_t count, double* squared) const;

    // Sets the flag of every cell that may contain a point x with |x - point| <= radius along each axis. Returns
    // their number.
    std::size_t mark(const double* point, double radius, std::vector<std::uint8_t>& flags) const;

    // Cells per unit of length, the same along each axis; 0 if there is only one cell.
    double cells_per_length() const { return layout_.cells_per_length; }

    // Return the number of occupied cells and one point of each. The points are spread evenly, however the density
    // varies.
    std::size_t occupied() const { return occupied_; }
    Points spread() const;

    // Does the same for every cell that may contain a point whose computed squared distance is at most `squared`.
    // Along each axis its exact distance is at most distance_at_most(squared) (kernel/rounding.h).
    std::size_t mark_within(const double* point, double squared, std::vector<std::uint8_t>& flags) const {
        return mark(point, distance_at_most(squared, true), flags);
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

}  // namespace hausbench
