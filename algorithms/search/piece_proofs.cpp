#include "algorithms/search/piece_proofs.h"

#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <optional>

namespace hausbench {
namespace {

using Corners = std::array<Vec3, 3>;

// Limit on the cuts made after the search. If the proof needs more, the result has no certificate.
constexpr std::uint64_t most_more_cuts = 1'000'000;

// The certificate claims a bound, `proven`, that exceeds the upper bound of the search, so that a checker, which rounds
// outward itself, can confirm it. Let u = 2^-53, and let D be the diagonal of the box around both meshes. The excess is
// the sum of
// - (14 L + 100) u D for the checker's own rounding after L nested cuts (cover_certificate.h). L <= 156: three cuts for
//   each of 50 levels, or one for each of 102, and at most six for the cells;
// - 100 u D for the rounding of the corners of cells, which is less (piece_cells.h);
// - `slack` u D if some piece was bounded again.
// The two terms of 100 are `loss_of_check`. The sum is at most (14 * 156 + 200 + 4096) u D = 6480 u D, less than
// 1e-12 D = 9007 u D.
constexpr double loss_of_check = 200, loss_of_cut = 14, slack = 4096;

// Writes the cuts that divide a piece into its parts. Calls next(i) where the subtree of part i belongs, so that next()
// can write it.
template <class Write>
void write_cuts(CertificateTree& tree, Split split, PieceTurn turn, std::size_t opposite, const Write& next) {
    if (split == Split::longest_edge) {
        tree.cut(CutPoint::corner(turn.place(opposite)), CutPoint::along(turn.place(opposite + 1), 0.5));
        next(0);
        next(1);
        return;
    }
    // Vertices 3, 4, 5 are the midpoints of the edges opposite to corners 0, 1, 2. The first cut, from 4 to 5, cuts off
    // corner 0 and leaves the polygon 5, 1, 2, 4. The next, from 5 to 3, cuts off corner 1 and leaves 3, 2, 4, 5. The
    // last, from 3 to 4, cuts off corner 2 and leaves 4, 5, 3, the part in the middle.
    tree.cut(CutPoint::along(turn.place(2), 0.5), CutPoint::along(turn.place(0), 0.5));
    next(0);
    tree.cut(CutPoint::corner(0), CutPoint::along(1, 0.5));
    next(1);
    tree.cut(CutPoint::corner(0), CutPoint::corner(2));
    next(2);
    next(3);
}

// The `turn` of each part (PieceTurn in piece_cells.h): by how many places write_cuts() rotates the corners that
// cut_triangle() gives the part.
constexpr std::array<std::uint8_t, 4> turns_of_four = {1, 1, 1, 2};
constexpr std::array<std::uint8_t, 2> turns_of_two = {0, 2};

std::uint8_t turn_of(Split split, std::size_t part) {
    return split == Split::midpoint
               ? WATCHED_ELSE("proofs: how the corners of four parts stand", turns_of_four[part], turns_of_four[0])
               : WATCHED("proofs: how the corners of two parts stand", turns_of_two[part]);
}

constexpr std::size_t parts_of(Split split) { return split == Split::midpoint ? 4 : 2; }

// Repeats a cut of the search to get the corners of the parts with the same rounding, but computes no distances.
struct PointCut {
    struct Vertex {
        Vec3 point;
    };
    Cut<Vertex> cut;

    PointCut(const Corners& c, Split split)
        : cut(cut_triangle(std::array<Vertex, 3>{{{c[0]}, {c[1]}, {c[2]}}}, split,
                           [](const Vec3& point, const Vertex&) { return Vertex{point}; })) {}

    Corners corners(std::size_t part) const {
        const auto v = cut.corners(part);
        return {v[0].point, v[1].point, v[2].point};
    }
};

std::size_t opposite_of(const Cut<PointCut::Vertex>& cut) { return cut.pieces[0][0]; }

}  // namespace

PieceProofs::PieceProofs(const MeshPair& pair, Split split)
    : pair_(pair), split_(split), nodes_(static_cast<std::size_t>(pair.source.triangles.rows())) {}

PieceProofs::Node PieceProofs::cut(Node piece, std::size_t opposite) {
    const auto first = static_cast<Node>(nodes_.size());
    Entry part;
    Entry& whole = nodes_[piece];
    whole.first = first;
    whole.opposite = static_cast<std::uint8_t>(opposite);
    if (WATCHED("proofs: a part has the triangle of the whole", whole.near >= 0)) {
        part.upper = whole.upper;
        part.near = whole.near;
    }
    whole.tree.clear();
    for (std::size_t i = 0; i < parts_of(split_); ++i) {
        part.turn.turn = turn_of(split_, i);
        nodes_.push_back(part);
    }
    return first;
}

void PieceProofs::prove(Node piece, double upper, Index near) {
    Entry& entry = nodes_[piece];
    if (!(upper < entry.upper)) return;
    entry.upper = upper;
    entry.near = near;
    entry.tree.clear();
}

void PieceProofs::prove(Node piece, double upper, const PieceArgument& argument, const PieceCorners& corners) {
    if (argument.kind == PieceArgument::Kind::whole_piece) return prove(piece, upper, argument.near);
    Entry& entry = nodes_[piece];
    if (!(upper < entry.upper)) return;
    entry.upper = upper;
    entry.near = -1;
    entry.tree.clear();
    write_cells(entry.tree, argument, corners, entry.turn);
}

void PieceProofs::one_for_all(Index near) {
    if (WATCHED("proofs: one triangle for all of A where time is out", true)) {
        for (Entry& entry : nodes_) entry = {-1, {}, near, 0, {}, 0};
    }
}

// --- writing the certificate after the search ------------------------------------------------------------------------

// Writes the proof of each triangle of A as a tree of one certificate.
class PieceProofs::Writing {
public:
    Writing(const PieceProofs& proofs, double upper)
        : proofs_(proofs),
          bounds_(proofs.pair_.target, proofs.pair_.magnitude, uncounted_),
          upper_(upper),
          unit_(unit_roundoff * diagonal_of(proofs.pair_)),
          slack_(slack * unit_) {}

    // Writes the tree of triangle i. Returns false if this needs too many cuts.
    bool triangle(Index i, CertificateTree& tree) {
        const auto v = proofs_.pair_.source.triangles.row(i);
        const Points& points = proofs_.pair_.points;
        return piece(static_cast<Node>(i), {points.row(v[0]), points.row(v[1]), points.row(v[2])}, 0, tree);
    }

    // Returns by how much a checker's bound may exceed the upper bound of the search.
    double loss() const { return (loss_of_cut * depth_ + loss_of_check) * unit_ + (looked_again_ > 0 ? slack_ : 0); }

    // Returns the number of pieces bounded again after the search.
    std::uint64_t looked_again() const { return looked_again_; }

private:
    struct More {  // a piece to be bounded again
        Corners corners;
        int level;
        PieceTurn turn;
        Index near;  // triangle of B to try first; -1: none
    };

    // Writes the subtree of a piece, with its parts. Returns false if this needs too many cuts.
    bool piece(Node node, const Corners& corners, int level, CertificateTree& tree) {
        const Entry& entry = proofs_.nodes_[node];
        if (entry.first == 0) return leaf(entry, corners, level, tree);
        const PointCut parts(corners, proofs_.split_);
        bool all = true;
        write_cuts(tree, proofs_.split_, entry.turn, entry.opposite, [&](std::size_t i) {
            all = all && piece(entry.first + static_cast<Node>(i), parts.corners(i), level + 1, tree);
        });
        return all;
    }

    bool leaf(const Entry& entry, const Corners& corners, int level, CertificateTree& tree) {
        if (WATCHED("proofs: what was settled by a larger piece is bounded anew", !(entry.upper <= upper_)))
            return look_again({corners, level, entry.turn, entry.near}, tree);
        reach(level);
        if (entry.near >= 0)
            tree.one(entry.near);
        else
            tree.append(entry.tree);
        return true;
    }

    // Bounds a piece again. If the new bound is too large, cuts the piece and treats its parts in the same way. Returns
    // false if this needs too many cuts. A new bound may exceed the final upper bound by `slack_`, because it includes
    // more rounding.
    bool look_again(const More& more, CertificateTree& tree) {
        PieceCorners corners;
        Index near = more.near;
        for (std::size_t i = 0; i < 3; ++i) {
            const ClosestPoint nearest = proofs_.pair_.target.closest(more.corners[i], near, uncounted_);
            near = nearest.triangle;
            corners[i] = {more.corners[i], nearest.squared_distance, near};
        }
        ++looked_again_;
        if (leaf_of(corners, more, tree)) return true;
        if (more.level >= most_levels(proofs_.split_) || ++more_cuts_ > most_more_cuts) return false;
        const PointCut parts(more.corners, proofs_.split_);
        bool all = true;
        write_cuts(tree, proofs_.split_, more.turn, opposite_of(parts.cut), [&](std::size_t i) {
            all = all && look_again({parts.corners(i), more.level + 1, {turn_of(proofs_.split_, i)}, near}, tree);
        });
        return all;
    }

    // Tries several bounds of the piece and writes the cells of the first one that is small enough. Returns false if
    // none is.
    bool leaf_of(const PieceCorners& corners, const More& more, CertificateTree& tree) {
        const auto suffices = [&](double upper) {
            if (!WATCHED_ELSE(
                    "proofs: a piece that is bounded anew suffices for the answer",
                    upper <= upper_ + WATCHED("proofs: room for rounding where a piece is bounded anew", slack_), true))
                return false;
            reach(more.level);
            write_cells(tree, bounds_.argument(), corners, more.turn);
            return true;
        };
        return (more.near >= 0 && suffices(bounds_.nearest_triangles(corners, more.level, more.near))) ||
               suffices(bounds_.nearest_triangles(corners, more.level)) || suffices(bounds_.u3(corners, more.level)) ||
               suffices(bounds_.u4(corners, more.level));
    }

    // Updates `depth_` for a piece of this level that is not cut further: up to three cuts for each level (one if the
    // longest edge was cut), and six for the cells of the piece.
    void reach(int level) { depth_ = std::max(depth_, (proofs_.split_ == Split::midpoint ? 3 : 1) * level + 6); }

    const PieceProofs& proofs_;
    Counters uncounted_;
    PieceBounds bounds_;
    double upper_, unit_, slack_;
    std::uint64_t more_cuts_ = 0, looked_again_ = 0;
    int depth_ = 0;  // upper bound on the number of nested cuts above a leaf
};

void PieceProofs::finish(Result& result) const {
    CertificateBuilder builder(pair_.source.triangles.rows());
    Writing writing(*this, result.bounds.upper);
    CertificateTree tree;
    for (Index i = 0; i < pair_.source.triangles.rows(); ++i) {
        tree.clear();
        if (!writing.triangle(i, tree)) {
            result.why_no_certificate =
                "a piece that was settled by the bound of a larger one needs more cuts than are tried, as happens far "
                "from the origin; move both shapes near the origin, or use another of guthe, kang and cover";
            return;
        }
        builder.set(i, tree);
    }
    result.reported[std::string(pieces_bounded_anew)] = static_cast<double>(writing.looked_again());
    if (auto certificate = builder.finish(result.bounds.upper + writing.loss()))
        result.certificates = {std::move(*certificate)};
}

}  // namespace hausbench
