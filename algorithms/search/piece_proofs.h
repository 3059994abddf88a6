// The certificate of a search that cuts triangles of A into pieces at midpoints (subdivision.h) and bounds each piece:
// guthe and the solvers of meshes/cascade. It consists of the search's own pieces and arguments, which the search
// reports while it runs:
//
// - The cuts. The format only has cuts into two, so a cut into four pieces takes three of them: each cuts off a
//   corner, and the piece in the middle remains.
// - For each piece, the least bound found for it, and the reason why it holds: one triangle of B, or further cuts into
//   cells with one triangle of B each (piece_cells.h). A bound by one triangle also holds for every part of the piece,
//   so the parts inherit it. A bound by cells is not inherited, because the cells of a piece do not fit its parts.
//
// So one kind of argument is missing. If the parent of a part was bounded by cells, and no bound of the part itself is
// less, the search may settle the part by the bound of its parent. (In guthe this does not happen.) After the search,
// such a part is measured and bounded again, with nearest_triangles, u3 and u4 of piece_bounds.h, and cut further until
// one of these is at most the final upper bound, up to rounding (`slack` in piece_proofs.cpp). This is the only step of
// the proof that the search itself did not take. If it needs too many cuts, the result has no certificate.
//
// Nothing here changes the search; this is used only if a certificate is wanted.
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

// The name in Result::reported for the number of pieces that were bounded again after the search, see above.
inline constexpr std::string_view pieces_bounded_anew = "proof: pieces bounded anew";

// Collects the proof of a search's upper bound while the search runs, and writes the certificate at its end.
class PieceProofs {
public:
    using Node = std::uint32_t;  // the number of a piece; node i < |A| is triangle i of A

    // Keeps the references in `pair`.
    PieceProofs(const MeshPair& pair, Split split);

    // Records that the search cut a piece. If the longest edge was cut, `opposite` is the corner opposite to it.
    // Returns the node of the first part; the other parts have the numbers after it. At most 2^32 nodes.
    Node cut(Node piece, std::size_t opposite = 0);

    // Returns the least upper bound of this piece that was reported or inherited so far.
    double upper(Node piece) const { return nodes_[piece].upper; }

    // Reports that no point of the piece is farther than `upper` from triangle `near` of B. Has no effect unless
    // `upper` is less than upper(piece).
    void one(Node piece, double upper, Index near);

    // Reports an upper bound of piece_bounds.h with its argument. Has no effect unless `upper` is
    // less than upper(piece).
    void prove(Node piece, double upper, const PieceArgument& argument, const PieceCorners& corners);

    // Replaces all proofs with one that compares every triangle of A with triangle `near` of B. For a search that ran
    // out of time before every triangle of A had a bound.
    void one_for_all(Index near);

    // Sets the certificate of `result`, or the reason why it has none. O(nodes), plus closest point queries for the
    // pieces that are bounded again.
    void finish(Result& result) const;

private:
    struct Entry {
        double upper = std::numeric_limits<double>::infinity();
        CertificateTree tree;  // the cells of the piece; empty: the whole piece is near triangle `near`
        Index near = -1;
        Node first = 0;  // the first of its parts; 0: it was not cut
        PieceTurn turn;
        std::uint8_t opposite = 0;
    };
    class Writing;

    MeshPair pair_;
    Split split_;
    std::vector<Entry> nodes_;
};

}  // namespace hausbench
