// Writes each PieceArgument (piece_bounds.h) as a tree of a certificate (certificate/cover_certificate.h): the cuts of
// a piece into cells, and for each cell the triangle of B near it.
//
// A certificate is about exact points, but the corners of cells were computed with rounding. The bounds leave room for
// this difference, except for two kinds of corners, which are computed here:
// - Kind::nearest_corner (u2): the cell of a corner holds the points nearest to this corner. Points are taken relative
//   to the first corner of the piece, so no rounded number is larger than the longest edge e of the piece. The *chord*
//   between the cells of corners a and b is the line on which f(x) = |b - a|^2 / 2 - (x - a).(b - a) is 0; f(x) is half
//   of |x - b|^2 - |x - a|^2. Rounding f costs less than 10u e |b - a| (u = 2^-53) at either end of an edge, so |f| is
//   less than 20u e |b - a| at the ends of the computed chord. There, |x - a| and |x - b| differ by
//   2 |f| / (|x - a| + |x - b|) < 40u e, because the sum in the denominator is at least |b - a|. So a point in the cell
//   of a corner is at most 40u e farther from that corner than from its nearest corner.
// - Kind::three (u3): the barycentre is a third of the way along a median. The double 1/3 is off by less than u, so the
//   point is off by less than u e.
// PieceProofs::finish() leaves more room than that.
#pragma once

#include "algorithms/certificate/cover_certificate.h"
#include "algorithms/search/piece_bounds.h"

#include <cstddef>
#include <cstdint>

namespace hausbench {

// By how many places the list of a piece's corners is rotated in a certificate: corner i of the piece is corner
// (i + turn) % 3 of its polygon.
struct PieceTurn {
    std::uint8_t turn = 0;

    // Returns the index in the polygon of corner i, and of the edge from corner i to the next one.
    std::size_t place(std::size_t i) const { return (i + turn) % 3; }
};

// Appends the subtree of a piece: its cuts into cells, and for each cell a leaf with the triangle of B near it.
void write_cells(CertificateTree& tree, const PieceArgument& argument, const PieceCorners& corners, PieceTurn turn);

}  // namespace hausbench
