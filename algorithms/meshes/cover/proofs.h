// Builds the certificate of a threshold cover (certificate/cover_certificate.h). It has one tree for each triangle of
// A. But the pieces of a triangle are finished at different times and in any order, so each piece has a tree of its
// own, and finish() joins them.
#pragma once

#include "algorithms/certificate/cover_certificate.h"

#include <array>
#include <cstddef>
#include <deque>
#include <optional>

namespace hausbench::cover {

class Proofs {
public:
    // Starts with one piece for each triangle of A; piece i is triangle i.
    explicit Proofs(Index triangles) : triangles_(triangles), pieces_(static_cast<std::size_t>(triangles)) {}

    CertificateTree& tree(Index piece) { return pieces_[static_cast<std::size_t>(piece)].tree; }

    // Records that a piece is cut in two along the line from p to q. Returns the indices of the two new pieces, in the
    // order of CertificateTree::cut().
    std::array<Index, 2> halve(Index piece, const CutPoint& p, const CutPoint& q) {
        const auto next = static_cast<Index>(pieces_.size());
        Piece& cut = pieces_[static_cast<std::size_t>(piece)];
        cut.tree.cut(p, q);
        cut.first = next;
        pieces_.resize(pieces_.size() + 2);
        return {next, next + 1};
    }

    // Returns the certificate for the upper bound `proven`. Returns nothing if the search ended before every piece was
    // covered.
    std::optional<Certificate> finish(double proven) const {
        CertificateBuilder builder(triangles_);
        for (Index i = 0; i < triangles_; ++i) {
            CertificateTree whole;
            if (!append(i, whole)) return std::nullopt;
            builder.set(i, whole);
        }
        return builder.finish(proven);
    }

private:
    struct Piece {
        CertificateTree tree;
        Index first = -1;  // the first of the two pieces that it was cut into; -1: not cut
    };

    // Appends to `whole` the tree of a piece and the trees of all pieces that it was cut into. Returns false if one of
    // them is empty.
    bool append(Index piece, CertificateTree& whole) const {
        const Piece& entry = pieces_[static_cast<std::size_t>(piece)];
        if (entry.tree.bytes().empty()) return false;
        whole.append(entry.tree);
        return entry.first < 0 || (append(entry.first, whole) && append(entry.first + 1, whole));
    }

    Index triangles_;
    std::deque<Piece> pieces_;  // references stay valid as it grows
};

}  // namespace hausbench::cover
