// Cuts a piece in two or three: in the middle of an edge, or along the line on which the nearest triangle of B changes.
#pragma once

#include "algorithms/meshes/distribution/mean_bounds.h"

#include <array>
#include <cstddef>
#include <span>

namespace hausbench::distribution {

// Cuts the longest edge in the middle.
std::array<Piece, 2> halves(const Piece& piece);

// The parts of a piece. Empty if it cannot be cut this way.
struct Parts {
    std::array<Piece, 3> pieces;
    std::size_t count = 0;

    const Piece* begin() const { return pieces.data(); }
    const Piece* end() const { return pieces.data() + count; }
};

// Cuts a piece where the nearest triangle of B changes: between the triangle nearest to the centre, which is the first
// of `kept`, and the one that is nearer to a corner by most. If none is, cuts along the plane of the nearest triangle.
// `kept` and `squares` are kept() and kept_squares() of a MeanBounder, `magnitude` is M of kernel/rounding.h. The cut
// need not be exact: any cut is valid, and the level of the parts covers the rounding errors of their corners.
Parts cut_at_change(const Piece& piece, std::span<const NearbyTriangle> near, std::span<const std::uint16_t> kept,
                    std::span<const CornerValues> squares, double magnitude);

}  // namespace hausbench::distribution
