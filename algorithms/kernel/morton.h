// Sorts points along a space-filling curve (Morton or Hilbert), so that points that are neighbours in the order are
// mostly neighbours in space. Rounding errors in the order do not matter: trees and search orders depend on it, but
// bounds do not.
//
// Source: Morton, A computer oriented geodetic data base, 1966.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/parallel.h"

#include <cstdint>
#include <vector>

namespace hausbench {

// A cube divided into 2^10 cells along each axis, 2^30 in all. Each cell has a key; sorting points by the keys of their
// cells puts them in Morton order. Points outside the cube are clamped to its faces.
class MortonFrame {
public:
    explicit MortonFrame(const Box& box);

    // Returns the Morton key of the cell that contains the point. It has 30 bits: the highest three say in which half
    // of the cube the cell lies along x, y and z, the next three in which half of that half, and so on.
    std::uint32_t key(const double* point) const;

    // Returns whether `first` precedes `second` in Morton order. Compares 52 bits per coordinate, so it also orders
    // points of the same cell.
    bool before(const double* first, const double* second) const;

    // Returns a smaller cube in which the points of one cell can be sorted further; `box` is their bounding box. Among
    // the cubes that arise by halving this cube repeatedly, it is the smallest around the box, so sorting in it
    // continues the same Morton order. If 52 halvings do not separate the points, returns a cube around the box itself.
    MortonFrame inside(const Box& box) const;

private:
    MortonFrame(const Vec3& low, double width);
    std::uint64_t halvings_of(double x, int axis) const;

    Vec3 low_;
    double width_, cells_per_length_ = 0;
};

// Returns the chosen rows of `points` (all rows if `chosen` is null) in Morton order. If a cell contains more than 32
// points, they are sorted again in a smaller frame, and so on, so dense clusters are sorted as well as the rest. Up to
// 32 points in one cell are ordered by row. Apart from these, two sets sorted in the same frame follow the same curve.
//
// Takes O(n) memory. Takes O(n) time, by radix sort, if few cells need a smaller frame. A smaller frame is at least
// 2^10 times smaller, so data that mix scales may take another O(n) for each factor of 2^10 between the scales.
std::vector<Index> morton_order(const Points& points, const std::vector<Index>* chosen, const MortonFrame& frame);

// Converts the Morton key of a cell to the cell's position on the Hilbert curve through all 2^30 cells. Consecutive
// cells of the Hilbert curve are always neighbours in space, whereas the Morton curve jumps. So a run of consecutive
// points has a smaller bounding box in Hilbert order.
// Source: Hamilton and Rau-Chaplin, Compact Hilbert indices, 2008: the same curve, here as a table of 24 states.
std::uint32_t hilbert_key(std::uint32_t morton_key);

// Returns the rows of all points in the order of the Hilbert keys of their cells. If a cell contains more than 32
// points, they are sorted again along a smaller Hilbert curve inside the cell. Takes as much time and memory as
// morton_order().
std::vector<Index> hilbert_order(const Points& points, const MortonFrame& frame, const Threads& threads = Threads());

}  // namespace hausbench
