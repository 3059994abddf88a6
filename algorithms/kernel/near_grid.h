// A coarse grid over a point set that knows, for each cell, a point in or near it: a cheap first guess of what is close.
//
// One pass over the points, and two sweeps that carry the nearest occupied cell into empty ones. Guesses need not be the
// closest points: they are true points, whose distances bound the closest one's from above.
#pragma once

#include "box.h"

#include <cstdint>
#include <vector>

namespace hausbench {

class NearGrid {
public:
    struct Guess {
        double point[3];
        Index row;
    };

    NearGrid() = default;

    // `box` is that of `points`. About an eighth as many cells as points, 2^16 at most. O(n + cells).
    NearGrid(const Points& points, const Box& box);

    // Points outside the box belong to the cell nearest to them along each axis.
    std::size_t cell_of(const double* point) const {
        return static_cast<std::size_t>(cell(point[0], 0) +
                                        size_[0] * (cell(point[1], 1) + size_[1] * cell(point[2], 2)));
    }
    const Guess& guess(std::size_t cell) const { return guesses_[cell]; }
    const Guess& guess(const double* point) const { return guesses_[cell_of(point)]; }

    // Sets the flag of every cell that may hold a point within the exact distance `radius`; returns how many cells those
    // are. Rounding: coordinates are rounded outward, and cell() is monotone.
    std::size_t mark(const double* point, double radius, std::vector<std::uint8_t>& flags) const;

    std::size_t cells() const { return guesses_.size(); }
    std::size_t bytes() const { return guesses_.capacity() * sizeof(Guess); }

private:
    int cell(double x, int k) const {
        const double scaled = (x - low_[k]) * cells_per_length_;
        return static_cast<int>(std::min(std::max(scaled, 0.0), last_[k]));
    }

    double low_[3] = {}, last_[3] = {};
    double cells_per_length_ = 0;
    int size_[3] = {1, 1, 1};
    std::vector<Guess> guesses_;
};

}  // namespace hausbench
