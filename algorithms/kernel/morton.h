// Points in Morton order (Z order): neighbours in the order are mostly neighbours in space.
//
// Source: Morton, A computer oriented geodetic data base, 1966. Only the order of work and the shape of trees depend on it,
// never a bound, so its rounding does not matter.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/parallel.h"

#include <cstdint>
#include <vector>

namespace hausbench {

// A cube over a box, cut into 2^10 cells along each axis. Points outside are clamped to its faces.
class MortonFrame {
public:
    explicit MortonFrame(const Box& box);

    // Returns a key of 30 bits: three for each halving of the cube.
    std::uint32_t key(const double* point) const;

    // Returns whether `first` precedes `second` in the order of keys with 52 halvings.
    bool before(const double* first, const double* second) const;

    // Returns a frame in which to sort the points of one cell further; `box` is their bounding box. It is the
    // smallest cube reached by halving this one that contains the box, so sorting by it continues the order of this
    // frame. If 52 halvings do not separate the points, it is the frame of the box itself.
    MortonFrame inside(const Box& box) const;

private:
    MortonFrame(const Vec3& low, double width);
    std::uint64_t halvings_of(double x, int axis) const;

    Vec3 low_;
    double width_, cells_per_length_ = 0;
};

// Returns the chosen rows (all rows if `chosen` is null) sorted by key, with equal keys sorted by row. Points that
// share a cell are sorted again in a smaller frame until few are left in each cell, so outliers and clusters do not
// spoil the order. Two sets sorted in the same frame are in the same order, except for those few.
// Takes O(n) time for tame data, because it is a radix sort. Each smaller frame is at least 2^10 times smaller, so
// every factor of 2^10 between the scales of the data costs another O(n). O(n) memory.
std::vector<Index> morton_order(const Points& points, const std::vector<Index>* chosen, const MortonFrame& frame);

// Returns the position of a cell on the Hilbert curve through all 2^30 cells of a frame, given its Morton key.
// Cells that follow each other on the curve are neighbours in space, whereas Morton order jumps, so runs of points
// have smaller boxes.
// Source: Hamilton and Rau-Chaplin, Compact Hilbert indices, 2008: the same curve, as a table of 24 states.
std::uint32_t hilbert_key(std::uint32_t morton_key);

// Returns all rows sorted by the Hilbert keys of their cells. Points that share a cell are sorted by another curve
// through that cell, as in morton_order(), and at the same cost.
std::vector<Index> hilbert_order(const Points& points, const MortonFrame& frame, const Threads& threads = Threads());

}  // namespace hausbench
