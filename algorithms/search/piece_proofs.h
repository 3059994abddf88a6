// The certificate of a search that cuts triangles of A into pieces at midpoints (subdivision.h) and bounds each piece: guthe and the
// cascades. It is made of the search's own pieces and of its own arguments, which the search tells as it goes along:
//
// - The cuts. Four pieces at the midpoints of the edges are three cuts of the format: each takes a corner off, and what is left is the piece
//   in the middle.
// - Of each piece the least bound that was found for it, and why it holds: one triangle of B, or some cuts more, into cells with a
//   triangle of B each (piece_cells.h). A bound by one triangle is one for every part of the piece too, and parts inherit it.
//
// One argument is not told: a part that the search settles by the cells of the piece that it was cut from, because no bound of its own was
// less. In guthe there is none. When the search is over, such a part is measured and bounded anew, by the nearest triangles, u3 and u4
// of piece_bounds.h, and is cut further until one of these suffices for the final upper bound, but for rounding (`slack`). That is
// the one step of the proof that the search did not take; where it takes too many cuts there is no certificate.
//
// Nothing here changes the search; it is called only if a certificate is wanted.
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

// In Result::reported: pieces of the certificate that were bounded anew, as above.
inline constexpr std::string_view pieces_bounded_anew = "proof: pieces bounded anew";

class PieceProofs {
public:
    using Node = std::uint32_t;  // of a piece; node i < |A| is triangle i of A

    // References in `pair` are kept.
    PieceProofs(const MeshPair& pair, Split split);

    // Records that a piece is cut; `opposite` is the corner opposite to the longest edge if only that edge is cut.
    // Returns the node of the first part; the others follow it. At most 2^32 nodes.
    Node cut(Node piece, std::size_t opposite = 0);

    // The least upper bound that was told so far.
    double upper(Node piece) const { return nodes_[piece].upper; }

    // Records that no point of the piece is farther than `upper` from triangle `near` of B, if this is less than the
    // bound recorded before.
    void one(Node piece, double upper, Index near);

    // Likewise, with the argument of a bound of piece_bounds.h.
    void prove(Node piece, double upper, const PieceArgument& argument, const PieceCorners& corners);

    // For a search that ends before each triangle of A has a bound: `near` serves all of A.
    void one_for_all(Index near);

    // Gives `result` its certificate, or the reason why there is none. O(nodes), and closest point queries where cells were inherited.
    void finish(Result& result) const;

private:
    struct Entry {
        double upper = std::numeric_limits<double>::infinity();
        CertificateTree tree;  // of the cells; empty: `near` is the triangle for all of it
        Index near = -1;
        Node first = 0;  // of its parts; 0: it was not cut
        PieceTurn turn;
        std::uint8_t opposite = 0;
    };
    class Writing;

    MeshPair pair_;
    Split split_;
    std::vector<Entry> nodes_;
};

}  // namespace hausbench
