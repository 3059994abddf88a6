#include "piece_proofs.h"

#include <algorithm>
#include <optional>

namespace hausbench {
namespace {

using Corners = std::array<Vec3, 3>;

// Beyond this many cuts that the search did not take there is no certificate.
constexpr std::uint64_t most_more_cuts = 1'000'000;

// `proven` is above the upper bound by what the check may lose (cover_certificate.h), (14 L + 100) u D below L cuts, and by what
// chords of cells are off (piece_cells.h), less than 100 u D. L <= 156: three cuts for each of 50 levels, or one for each of 102, and
// at most six for the cells; so it is less than 1e-12 D in all.
constexpr double loss_of_check = 200, loss_of_cut = 14;

// The cuts that make the parts of a piece, told to a tree. One of four is left over from three cuts; `next` writes what stands between.
template <class Write>
void write_cuts(CertificateTree& tree, Split split, PieceTurn turn, std::size_t opposite, const Write& next) {
    if (split == Split::longest_edge) {
        tree.cut(CutPoint::corner(turn.place(opposite)), CutPoint::along(turn.place(opposite + 1), 0.5));
        next(0), next(1);
        return;
    }
    // Corner 0 is cut off from the middle of the edge to it, 4, to that of the edge from it, 5. What is left is 5, 1, 2, 4, then 3, 2, 4, 5,
    // then 4, 5, 3; 3 is opposite to corner 0.
    tree.cut(CutPoint::along(turn.place(2), 0.5), CutPoint::along(turn.place(0), 0.5));
    next(0);
    tree.cut(CutPoint::corner(0), CutPoint::along(1, 0.5));
    next(1);
    tree.cut(CutPoint::corner(0), CutPoint::corner(2));
    next(2), next(3);
}

// How the corners of the parts stand, of cut_triangle().
constexpr std::array<std::uint8_t, 4> turns_of_four = {1, 1, 1, 2};
constexpr std::array<std::uint8_t, 2> turns_of_two = {0, 2};

std::uint8_t turn_of(Split split, std::size_t part) {
    return split == Split::midpoint ? turns_of_four[part] : turns_of_two[part];
}

constexpr std::size_t parts_of(Split split) { return split == Split::midpoint ? 4 : 2; }

// The cut of the points alone, as the search made it.
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
    if (whole.near >= 0) part.upper = whole.upper, part.near = whole.near;
    whole.tree.clear();
    for (std::size_t i = 0; i < parts_of(split_); ++i) {
        part.turn.turn = turn_of(split_, i);
        nodes_.push_back(part);
    }
    return first;
}

void PieceProofs::one(Node piece, double upper, Index near) {
    Entry& entry = nodes_[piece];
    if (!(upper < entry.upper)) return;
    entry.upper = upper;
    entry.near = near;
    entry.tree.clear();
}

void PieceProofs::cells(Node piece, double upper, const CertificateTree& tree) {
    Entry& entry = nodes_[piece];
    if (!(upper < entry.upper)) return;
    entry.upper = upper;
    entry.near = -1;
    entry.tree = tree;
}

void PieceProofs::one_for_all(Index near) {
    for (Entry& entry : nodes_) entry = {-1, {}, near, 0, {}, 0};
}

// --- the search is over ------------------------------------------------------------------------------------------------

class PieceProofs::Writing {
public:
    Writing(const PieceProofs& proofs, double upper)
        : proofs_(proofs), target_(proofs.pair_.target), magnitude_(proofs.pair_.magnitude), upper_(upper) {}

    // False: too many cuts.
    bool triangle(Index i, CertificateTree& tree) {
        const auto v = proofs_.pair_.source.triangles.row(i);
        const Points& points = proofs_.pair_.points;
        return piece(static_cast<Node>(i), {points.row(v[0]), points.row(v[1]), points.row(v[2])}, 0, tree);
    }

    int depth() const { return depth_; }  // a bound of the cuts above a leaf

private:
    struct More {  // a piece that is looked at anew
        Corners corners;
        int level;
        PieceTurn turn;
        Index near;  // triangle of B where to begin, or -1
    };

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
        if (!(entry.upper <= upper_)) return look_again({corners, level, entry.turn, entry.near}, tree);
        reach(level);
        if (entry.near >= 0)
            tree.one(entry.near);
        else
            tree.append(entry.tree);
        return true;
    }

    // By the triangles nearest to its corners, and by that of the piece that it is part of.
    bool look_again(More more, CertificateTree& tree) {
        std::array<Index, 4> near{more.near, -1, -1, -1};
        for (std::size_t i = 0; i < 3; ++i) {
            const Index warm = i > 0 ? near[i] : more.near;
            near[i + 1] = target_.closest(more.corners[i], warm, uncounted_).triangle;
        }
        double least = std::numeric_limits<double>::infinity();
        for (const Index k : near) {
            if (k < 0) continue;
            const double most = squared_to_farthest(more.corners, k);
            if (most < least) least = most, more.near = k;
        }
        if (surface_distance_at_most(least, magnitude_, more.level) <= upper_) {
            reach(more.level);
            tree.one(more.near);
            return true;
        }
        if (more.level >= most_levels(proofs_.split_) || ++more_cuts_ > most_more_cuts) return false;
        const PointCut parts(more.corners, proofs_.split_);
        bool all = true;
        write_cuts(tree, proofs_.split_, more.turn, opposite_of(parts.cut), [&](std::size_t i) {
            all = all && look_again({parts.corners(i), more.level + 1, {turn_of(proofs_.split_, i)}, more.near}, tree);
        });
        return all;
    }

    double squared_to_farthest(const Corners& corners, Index k) const {
        const Triangle near = target_.triangle(k);
        double most = 0;
        for (const Vec3& corner : corners) most = std::max(most, target_.squared_distance(corner, near));
        return most;
    }

    // A leaf of this level.
    void reach(int level) { depth_ = std::max(depth_, (proofs_.split_ == Split::midpoint ? 3 : 1) * level + 6); }

    const PieceProofs& proofs_;
    const Target& target_;
    double magnitude_, upper_;
    Counters uncounted_;
    std::uint64_t more_cuts_ = 0;
    int depth_ = 0;
};

void PieceProofs::finish(Result& result) const {
    CertificateBuilder builder(pair_.source.triangles.rows());
    Writing writing(*this, result.bounds.upper);
    CertificateTree tree;
    for (Index i = 0; i < pair_.source.triangles.rows(); ++i) {
        tree.clear();
        if (!writing.triangle(i, tree)) {
            result.why_no_certificate =
                "the proof of a piece that was settled by the bound of a larger one takes too many cuts; ask for "
                "another "
                "tolerance or another solver";
            return;
        }
        builder.set(i, tree);
    }
    const double loss = (loss_of_cut * writing.depth() + loss_of_check) * unit_roundoff * diagonal_of(pair_);
    if (auto certificate = builder.finish(result.bounds.upper + loss)) result.certificates = {std::move(*certificate)};
}

}  // namespace hausbench
