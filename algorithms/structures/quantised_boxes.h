// The boxes of a node's children, with six bytes per box.
//
// A box has six sides, each in a *plane* orthogonal to an axis. A node stores its lower corner, `origin`, in double
// precision, and each plane of its children's boxes as one byte q: the plane lies at origin + q * step along its axis,
// where `step` is a power of two. Planes are rounded outward. Each node has its own step, so a stray triangle far away
// makes the other boxes in the same node coarse, but not the boxes in the nodes below them.
//
// The *content* of a box is everything that it was made to contain: the triangles below that child. The squared
// distance from a point to a box, as computed, never exceeds the squared distance to a point of the content, as
// computed. So a search may skip every box that seems farther than its best result; it needs no slack for rounding.
// There are two ways to compute the distance:
//   - Near the node, in integers: sixteenths of a step, rounded down (measure_near_boxes in wide_walk-inl.h).
//   - Far from the node, in double precision (measure_far_boxes): by the same operations as squared_distance_to_box
//     (box.h), which are monotone, applied to the planes as computed, fl(origin + q * step). QuantisedBoxes::set makes
//     sure that the content does not reach beyond these planes either.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/watched.h"

#include <cstdint>
#include <span>

namespace hausbench {

inline constexpr int tree_width = 8;  // children of a node

// Up to eight boxes, with one byte for each of their sides.
struct QuantisedBoxes {
    double origin[3];  // the lower corner of the box around all of them
    double step;       // a power of two from 2^-440 to 2^394
    double inverse;    // 1 / step
    // The lower and upper coordinates of each box, as numbers of steps from `origin`. The bytes for x and y are
    // adjacent, because wide_walk-inl.h squares and adds them in pairs.
    std::uint8_t low_xy[tree_width][2], low_z[tree_width], high_xy[tree_width][2], high_z[tree_width];

    std::uint8_t& low(int k, std::size_t i) { return k < 2 ? low_xy[i][k] : low_z[i]; }
    std::uint8_t& high(int k, std::size_t i) { return k < 2 ? high_xy[i][k] : high_z[i]; }

    // Returns the coordinate, along axis k, of a box side that is stored as q. The product q * step is exact, because
    // step is a power of two; only the sum is rounded.
    double plane(int k, std::uint8_t q) const { return origin[k] + q * step; }

    // Returns box i in double precision. It contains the box that was given to set().
    Box box(int i) const {
        return {
            {plane(0, low_xy[i][0]), plane(1, low_xy[i][1]), plane(2, low_z[i])},
            {plane(0, high_xy[i][0]), plane(1, high_xy[i][1]),
             plane(2, WATCHED_ELSE("wide tree: the upper plane of a child from its lower one", high_z[i], low_z[i]))}};
    }

    // Stores one to eight boxes, rounded outward, and returns the exact box around all of them. Their coordinates may
    // be up to 2^400. Unused entries repeat the first box.
    //
    // The stored boxes contain the given boxes as plane() computes them:
    //     plane(k, low(k, i)) <= boxes[i].low[k]  and  boxes[i].high[k] <= plane(k, high(k, i)).
    // They also do so in exact arithmetic, up to 2^-45 of a step:
    //     origin[k] + (low(k, i) - 2^-45) * step <= boxes[i].low[k]  and
    //     boxes[i].high[k] <= origin[k] + (high(k, i) + 2^-45) * step.
    Box set(std::span<const Box> boxes);
};

}  // namespace hausbench
