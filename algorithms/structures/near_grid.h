// A coarse grid over a point set that stores, for each cell, a point in or near it: a cheap first candidate for the closest.
//
// One pass over the points, and three sweeps that carry the nearest occupied cell into empty ones. Candidates need not be
// the closest points: they are points of the set, so their distances bound the closest one's from above.
#pragma once

#include "kernel/box.h"

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

    // `box` is that of `points`. The grid covers the part of it where most points are, so that a few outliers do not make its
    // cells large. About an eighth as many cells as points, 2^16 at most. O(n + cells).
    NearGrid(const Points& points, const Box& box);

    // Points outside the grid belong to the cell nearest to them along each axis. Monotone in each coordinate.
    std::size_t cell_of(const double* point) const {
        return static_cast<std::size_t>(cell(point[0], 0) +
                                        size_[0] * (cell(point[1], 1) + size_[1] * cell(point[2], 2)));
    }
    const Candidate& candidate(const double* point) const { return candidates_[cell_of(point)]; }

    // Sets the flag of every cell that may hold a point with |x - point| <= radius along each axis; returns how many cells
    // those are.
    std::size_t mark(const double* point, double radius, std::vector<std::uint8_t>& flags) const;

    std::size_t cells() const { return candidates_.size(); }
    std::size_t bytes() const { return candidates_.capacity() * sizeof(Candidate); }

private:
    int cell(double x, int k) const {
        const double scaled = (x - low_[k]) * cells_per_length_;
        return static_cast<int>(std::min(std::max(scaled, 0.0), last_[k]));
    }
    void lay_cells(const Box& box, double most);
    void fill_empty_cells();

    double low_[3] = {}, last_[3] = {};
    double cells_per_length_ = 0;
    int size_[3] = {1, 1, 1};
    std::vector<Candidate> candidates_;
};

}  // namespace hausbench
