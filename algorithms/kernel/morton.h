// Sorts points along a space-filling curve, in Morton order (Z order) or Hilbert order: points that are neighbours in
// the order are mostly neighbours in space.
//
// Source: Morton, A computer oriented geodetic data base, 1966. The order of work and the shape of trees depend on this
// order, but bounds do not, so its rounding errors do not matter.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/parallel.h"

#include <cstdint>
#include <vector>

namespace hausbench {

// A cube around a box, in which points get keys to sort by. The cube is halved along each axis ten times, which gives
// 2^10 cells along each axis, 2^30 in all. Points outside are clamped to the faces of the cube.
class MortonFrame {
public:
    explicit MortonFrame(const Box& box);

    // Returns the Morton key of the point's cell. It has 30 bits, three for each halving: the highest three say in
    // which half of the cube the cell lies along x, y and z, the next three in which half of that half, and so on.
    std::uint32_t key(const double* point) const;

    // Returns whether `first` precedes `second` in Morton order. Compares with 52 halvings, so it also tells apart
    // points of the same cell.
    bool before(const double* first, const double* second) const;

    // Returns a smaller frame, to sort points of one cell whose bounding box is `box`. Among the cubes that arise by
    // halving this frame again and again, it is the smallest that contains the box; so sorting by its keys continues
    // the Morton order of this frame. If 52 halvings do not separate the points, returns the frame of the box itself.
    MortonFrame inside(const Box& box) const;

private:
    MortonFrame(const Vec3& low, double width);
    std::uint64_t halvings_of(double x, int axis) const;

    Vec3 low_;
    double width_, cells_per_length_ = 0;
};

// Returns the chosen rows of `points` (all rows if `chosen` is null) in Morton order. If a cell contains more than 32
// points, they are sorted again in a smaller frame, and so on; so a cluster is sorted as well as the rest, however
// small it is beside the whole. The last 32 points or fewer of a cell are sorted by row. Apart from these, two sets
// sorted in the same frame follow the same curve.
//
// Takes O(n) memory and, because it is a radix sort, O(n) time for tame data: data in which few cells need a smaller
// frame. A smaller frame is smaller by a factor of at least 2^10, so data that mix scales may take another O(n) for
// each factor of 2^10 between the scales.
std::vector<Index> morton_order(const Points& points, const std::vector<Index>* chosen, const MortonFrame& frame);

// Returns the position of a cell on the Hilbert curve through all 2^30 cells of a frame, given the Morton key of the
// cell. Consecutive cells of the Hilbert curve are always neighbours in space, whereas the Morton curve jumps. So a run
// of consecutive points has a smaller bounding box in Hilbert order.
// Source: Hamilton and Rau-Chaplin, Compact Hilbert indices, 2008: the same curve, here as a table of 24 states.
std::uint32_t hilbert_key(std::uint32_t morton_key);

// Returns all rows sorted by the Hilbert keys of their cells. If a cell contains more than 32 points, they are sorted
// along another Hilbert curve, through a smaller frame, as in morton_order() and at the same cost.
std::vector<Index> hilbert_order(const Points& points, const MortonFrame& frame, const Threads& threads = Threads());

}  // namespace hausbench
