// The certificate of a threshold cover while it is made: pieces of A are covered in any order, and a piece that is halved is left to two
// others, so each piece writes a tree of its own and these are put together at the end.
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

    // Cuts a piece: its first child is the first of the two that are returned.
    std::array<Index, 2> halve(Index piece, const CutPoint& p, const CutPoint& q) {
        const auto next = static_cast<Index>(pieces_.size());
        Piece& cut = pieces_[static_cast<std::size_t>(piece)];
        cut.tree.cut(p, q);
        cut.first = next;
        pieces_.resize(pieces_.size() + 2);
        return {next, next + 1};
    }

    // None where a piece has no tree. O(bytes).
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
        Index first = -1;  // the first of two others that it was cut into, or -1
    };

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
