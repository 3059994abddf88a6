// The certificate of a search that cuts triangles of A into pieces at midpoints (subdivision.h) and bounds each piece:
// guthe, kang, zheng and sacht. The certificate repeats the search's own cuts and reasons, which the search
// reports while it runs:
//
// - The cuts. The certificate format only has cuts into two, so a cut into four pieces takes three of them: each cuts
//   off a corner, and the piece in the middle remains.
// - For each piece, the least bound found for it, and the reason why it holds: the whole piece is near one triangle of
//   B, or it is cut into cells, each near one triangle of B (piece_cells.h). The parts of a piece inherit a bound by
//   one triangle, because it holds for every part. They do not inherit a bound by cells, because the cells of a piece
//   do not fit its parts.
//
// So one reason may be missing. If a piece was bounded by cells, and a part of it has no smaller bound of its own, the
// search may drop the part because of the bound of the piece. (In guthe this does not happen.) After the search, such a
// part is measured and bounded again, with nearest_triangles, u3 and u4 of piece_bounds.h, and cut further until one of
// these bounds is at most the final upper bound, up to rounding (`slack` in piece_proofs.cpp). If this needs too many
// cuts, the result has no certificate.
//
// Nothing here changes the search.
#pragma once

#include "algorithms/certificate/cover_certificate.h"
#include "algorithms/search/mesh_solver.h"
#include "algorithms/search/piece_cells.h"
#include "algorithms/search/subdivision.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

// The name in Result::reported for the number of pieces that were bounded again after the search, to complete the
// proof.
inline constexpr std::string_view pieces_bounded_anew = "proof: pieces bounded anew";

// Collects the proof of the upper bound while a search runs, and writes the certificate at the end.
class PieceProofs {
public:
    using Node = std::uint32_t;  // the number of a piece; node i < |A| is triangle i of A

    // Keeps the references in `pair`.
    PieceProofs(const MeshPair& pair, Split split);

    // Records that the search cut a piece. If the longest edge was cut, `opposite` is the corner opposite to it.
    // Returns the number of the first part; the other parts have the next numbers. At most 2^32 pieces.
    Node cut(Node piece, std::size_t opposite = 0);

    // Returns the least upper bound of this piece that was reported so far, or inherited from the piece that it is part
    // of.
    double upper(Node piece) const { return nodes_[piece].upper; }

    // Records an upper bound of a piece: none of its points is farther than `upper` from triangle `near` of B. Has no
    // effect unless `upper` is less than upper(piece).
    void prove(Node piece, double upper, Index near);

    // Records an upper bound from PieceBounds, with the reason why it holds. Has no effect unless `upper` is less than
    // upper(piece).
    void prove(Node piece, double upper, const PieceArgument& argument, const PieceCorners& corners);

    // Replaces all proofs with one: every point of A is compared with triangle `near` of B. For a search that ran out
    // of time before every triangle of A had a bound.
    void one_for_all(Index near);

    // Stores the certificate in `result`, or the reason why it has none. O(nodes), plus closest point queries for the
    // pieces that are bounded again.
    void finish(Result& result) const;

private:
    struct Entry {
        double upper = std::numeric_limits<double>::infinity();
        CertificateTree tree;  // the cells of the piece; empty: the whole piece is near triangle `near`
        Index near = -1;
        Node first = 0;  // the first part; 0: not cut
        PieceTurn turn;
        std::uint8_t opposite = 0;
    };
    class Writing;

    MeshPair pair_;
    Split split_;
    std::vector<Entry> nodes_;
};

}  // namespace hausbench
