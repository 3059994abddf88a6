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

// A cube over a box, cut into 2^10 cells along each axis. Points outside count as those at its faces.
class MortonFrame {
public:
    explicit MortonFrame(const Box& box);

    // 30 bits, three for each halving of the cube.
    std::uint32_t key(const double* point) const;

    // Whether the first comes before the second in the order of the keys that 52 halvings would give.
    bool before(const double* first, const double* second) const;

    // Returns a frame for the points of one cell with this box: the smallest frame that halving the cube leads to and
    // that still tells some of them apart, so that sorting by it continues the order of this one. If there is none,
    // the frame of their own box.
    MortonFrame inside(const Box& box) const;

private:
    MortonFrame(const Vec3& low, double width);
    std::uint64_t halvings_of(double x, int axis) const;

    Vec3 low_;
    double width_, cells_per_length_ = 0;
};

// Sorts the chosen rows (all rows if `chosen` is null) by key, equal keys by row. Points that share a cell are sorted again in
// a smaller frame, until few are left in each, so that outliers and clusters do not spoil the order. Two sets sorted in one
// frame are in one order, but for those few.
// O(n) time for tame data: a radix sort. Each smaller frame is at least 2^10 times smaller: O(n) more for each factor of 2^10
// between the scales of the data. O(n) memory.
std::vector<Index> morton_order(const Points& points, const std::vector<Index>* chosen, const MortonFrame& frame);

// The place of a cell along the Hilbert curve through all 2^30 cells of a frame, from its key. Neighbours on the curve are neighbours in
// space, where Morton order jumps: runs of it have smaller boxes.
// Source: Hamilton and Rau-Chaplin, Compact Hilbert indices, 2008: the same curve, as a table of 24 states.
std::uint32_t hilbert_key(std::uint32_t morton_key);

// Orders all rows by the Hilbert keys of their cells. Points that share a cell are ordered as in morton_order, by a
// curve through each, again in O(n).
std::vector<Index> hilbert_order(const Points& points, const MortonFrame& frame, const Threads& threads = Threads());

}  // namespace hausbench
