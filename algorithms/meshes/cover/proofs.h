// Builds the certificate of a threshold cover (certificate/cover_certificate.h). The certificate has one tree for each
// triangle of A, but the pieces of a triangle are covered at different times and in any order. So each piece has a tree
// of its own, and finish() joins them.
#pragma once

#include "algorithms/certificate/cover_certificate.h"

#include <array>
#include <cstddef>
#include <deque>
#include <optional>

namespace hausbench {

class CoverProofs {
public:
    // Pieces 0 to triangles - 1 are the triangles of A.
    explicit CoverProofs(Index triangles) : triangles_(triangles), pieces_(static_cast<std::size_t>(triangles)) {}

    CertificateTree& tree(Index piece) { return pieces_[static_cast<std::size_t>(piece)].tree; }

    // Records that a piece is cut along the line from p to q. Returns the two new pieces: the first and the second
    // child of CertificateTree::cut().
    std::array<Index, 2> halve(Index piece, const CutPoint& p, const CutPoint& q) {
        const auto next = static_cast<Index>(pieces_.size());
        Piece& cut = pieces_[static_cast<std::size_t>(piece)];
        cut.tree.cut(p, q);
        cut.first = next;
        pieces_.resize(pieces_.size() + 2);
        return {next, next + 1};
    }

    // Returns the certificate for the upper bound `proven`, or nothing if some piece has an empty tree, because the
    // search ended before that piece was covered. Takes O(bytes).
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
        Index first = -1;  // the first of the two pieces that it was cut into, or -1
    };

    // Appends the trees of a piece and of all pieces that it was cut into. Returns false if one of them is empty.
    bool append(Index piece, CertificateTree& whole) const {
        const Piece& own = pieces_[static_cast<std::size_t>(piece)];
        if (own.tree.bytes().empty()) return false;
        whole.append(own.tree);
        return own.first < 0 || (append(own.first, whole) && append(own.first + 1, whole));
    }

    Index triangles_;
    std::deque<Piece> pieces_;  // references stay valid as it grows
};

}  // namespace hausbench
