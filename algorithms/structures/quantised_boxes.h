// The boxes of a node's children, with one byte per plane.
//
// A node stores its lower corner in double precision, and each plane of its children's boxes as one byte: the
// number of steps from that corner, rounded outward, where the step is a power of two. So every level has its own
// precision: a stray triangle far away makes the boxes beside it coarse, but none of the boxes below them.
//
// The distance to a box never exceeds the computed squared distance to a point of its content, so no slack is
// needed elsewhere. Near a node, distances are integers in parts of its step, rounded down (measure_near_boxes in
// wide_walk-inl.h). Far from it (measure_far_boxes), they are computed by the operations of squared_distance_to_box
// (box.h), which are monotone, to the planes origin + q step as computed. These planes are no farther inside than
// any coordinate of the content (QuantisedBoxes::set).
#pragma once

#include "algorithms/kernel/box.h"

#include <cstdint>
#include <span>

namespace hausbench {

inline constexpr int tree_width = 8;  // children of a node

// Boxes around up to eight boxes, with one byte per plane.
struct QuantisedBoxes {
    double origin[3];  // the lower corner of the box around all of them
    double step;       // a power of two from 2^-440 to 2^394
    double inverse;    // 1 / step
    // The planes of x and y are side by side, as wide_walk-inl.h multiplies them.
    std::uint8_t low_xy[tree_width][2], low_z[tree_width], high_xy[tree_width][2], high_z[tree_width];

    std::uint8_t& low(int k, std::size_t i) { return k < 2 ? low_xy[i][k] : low_z[i]; }
    std::uint8_t& high(int k, std::size_t i) { return k < 2 ? high_xy[i][k] : high_z[i]; }

    // Returns a plane as computed: q step is exact, the sum is rounded.
    double plane(int k, std::uint8_t q) const { return origin[k] + q * step; }

    // Returns the box of child i from its computed planes; it contains the content of the child.
    Box box(int i) const {
        return {{plane(0, low_xy[i][0]), plane(1, low_xy[i][1]), plane(2, low_z[i])},
                {plane(0, high_xy[i][0]), plane(1, high_xy[i][1]), plane(2, high_z[i])}};
    }

    // Sets the boxes so that plane(k, low(k, i)) <= boxes[i].low[k] and boxes[i].high[k] <= plane(k, high(k, i)).
    // These are computed planes; in real numbers, origin + (q -+ 2^-45) step is no farther inside either. Unused
    // entries repeat the first. Takes one to eight boxes with coordinates up to 2^400. Returns the exact box around
    // all of them.
    Box set(std::span<const Box> boxes);
};

}  // namespace hausbench
