// The certificate of a search that cuts triangles of A into pieces at midpoints (subdivision.h) and bounds each
// piece: guthe and the cascades. It consists of the search's own pieces and arguments, which the search reports as
// it goes along:
//
// - The cuts. Four pieces at the midpoints of the edges are three cuts of the format: each cuts a corner off, and
//   the piece in the middle is left.
// - For each piece, the least bound found for it, and why it holds: one triangle of B, or some further cuts into
//   cells with one triangle of B each (piece_cells.h). A bound by one triangle also holds for every part of the
//   piece, so parts inherit it.
//
// One argument is not reported: the search may settle a part by the cells of its parent, because no bound of its own
// was less. (In guthe this does not happen.) After the search, such a part is measured and bounded again, by the
// nearest triangles, u3 and u4 of piece_bounds.h, and is cut further until one of these suffices for the final upper
// bound, up to rounding (`slack`). This is the only step of the proof that the search did not take; if it needs too
// many cuts, there is no certificate.
//
// Nothing here changes the search; it is used only if a certificate is wanted.
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

// In Result::reported: the number of pieces of the certificate that were bounded again, as above.
inline constexpr std::string_view pieces_bounded_anew = "proof: pieces bounded anew";

class PieceProofs {
public:
    using Node = std::uint32_t;  // the number of a piece; node i < |A| is triangle i of A

    // Keeps the references in `pair`.
    PieceProofs(const MeshPair& pair, Split split);

    // Cuts a piece. `opposite` is the corner opposite to the longest edge, if that edge is cut. Returns the node of
    // the first part; the others follow it. At most 2^32 nodes.
    Node cut(Node piece, std::size_t opposite = 0);

    // Returns the least upper bound reported so far.
    double upper(Node piece) const { return nodes_[piece].upper; }

    // Reports that no point of the piece is farther than `upper` from triangle `near` of B. Kept if this is less
    // than all earlier bounds.
    void one(Node piece, double upper, Index near);

    // The same, with the argument of a bound of piece_bounds.h.
    void prove(Node piece, double upper, const PieceArgument& argument, const PieceCorners& corners);

    // Uses triangle `near` for all of A, if time ran out before every triangle of A had a bound.
    void one_for_all(Index near);

    // Gives `result` its certificate, or the reason why there is none. O(nodes), plus closest point queries if
    // cells were inherited.
    void finish(Result& result) const;

private:
    struct Entry {
        double upper = std::numeric_limits<double>::infinity();
        CertificateTree tree;  // of the cells; empty: `near` is the triangle for the whole piece
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
