// The arguments of piece_bounds.h as trees of a certificate: the cuts of a piece into cells, and the triangle of B
// for each cell.
//
// The bounds leave room for the distance between the computed corners of cells and the exact points of the
// certificate, except for two kinds of corners that are chosen here:
// - Corners of cells of the points nearest to a corner of the piece (u2). Places are relative to the first corner
//   of the piece, so every rounded number is at most its longest edge e. A chord is where
//   f(x) = |b - a|^2 / 2 - (x - a)(b - a) is 0. f errs by less than 10 u e |b - a| at either end of an edge, so by
//   less than 20 u e |b - a| at the chord's ends. There |x - a| and |x - b| differ by
//   2 |f| / (|x - a| + |x - b|) < 40 u e, as that sum is at least |b - a|. So a point of the cell of a corner is at
//   most 40 u e farther from that corner than from the nearest one.
// - The barycentre, which is a third of the way along the median: the double 1/3 is off by less than u, and the
//   point by less than u e.
// PieceProofs::finish() leaves more room than that.
#pragma once

#include "algorithms/certificate/cover_certificate.h"
#include "algorithms/search/piece_bounds.h"

#include <cstddef>
#include <cstdint>

namespace hausbench {

// How the corners of a piece lie in its polygon of the certificate: corner i of the piece is corner i + turn of the
// polygon.
struct PieceTurn {
    std::uint8_t turn = 0;

    // Returns the place of corner i, or of the edge from it to the next.
    std::size_t place(std::size_t i) const { return (i + turn) % 3; }
};

// Writes the nodes of the polygon, down to its leaves.
void write_cells(CertificateTree& tree, const PieceArgument& argument, const PieceCorners& corners, PieceTurn turn);

}  // namespace hausbench
