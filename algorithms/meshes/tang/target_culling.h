// Culling on B (Tang et al. 2009, section 4.2). Sends a triangle T of A through a BVH of B and skips nodes farther
// from T than T's upper bound u. The remaining triangles give the distances of T's corners, u = the least h(T, S)
// over the triangles S of B (Eqs. 10, 11), and the list L of the triangles S near enough to bound the parts of T as
// well (Lemma 3).
//
// L: a piece T with corners v_i keeps S only if d(v_i, S) <= u + e_i for all i, where e_i is the longest edge at v_i.
// Let S be nearest to some p of T. Then d(p, S) <= h(T, B) <= u and |v_i - p| <= e_i, so S stays.
//
// Rounding: T stands for an exact piece within 2k uM of it, where k is its level (kernel/rounding.h), so e_i may be
// 6k uM too small; a computed distance may be too large by 10uM, as measured, and by 4u of itself. So (32 + 8k) uM is
// added, and 8u of the sum. No bound rests on this: h(T, S) is an upper bound for any S, and the farthest point is
// measured again against all of B. If S were missing, the search might end with `precision_floor`.
//
// A list of more than `most_listed` triangles is not kept: such a piece is measured by closest point queries, and its
// parts get another chance once they are so small that a list is likely. So the memory per piece does not depend on
// B, even if B has duplicates or a corner is at the centre of a sphere.
#pragma once

#include "algorithms/meshes/tang/short_lists.h"
#include "algorithms/meshes/tang/volumes.h"
#include "algorithms/search/bounds.h"
#include "algorithms/search/piece_bounds.h"
#include "algorithms/search/subdivision.h"

#include <array>
#include <limits>
#include <vector>

namespace hausbench {

// Largest number of triangles of B in a list, and before filtering.
inline constexpr std::size_t most_listed = 32, most_near = 128;

using Lists = ShortLists<most_listed>;

// A triangle of A or a part of one.
struct ListedPiece {
    PieceCorners corners;
    double upper = std::numeric_limits<double>::infinity();
    Index source = -1;        // triangle of A
    Index best = -1;          // triangle of B whose bound was least
    int level = 0;            // of rounding
    int depth = 0;            // number of subdivisions of its triangle
    Lists::List list;         // empty: none
    std::uint64_t crowd = 0;  // if it has no list: the number of triangles of B that seem to be near
};

// A triangle of B with its squared distance to each corner of a piece.
struct NearTriangle {
    Index triangle;
    std::array<double, 3> squared;
};

template <class Tree> class TargetCulling {
public:
    // Keeps references. `tree` is over B.
    TargetCulling(const Tree& tree, const Target& target, double magnitude, SearchBounds& bounds, Counters& counters)
        : tree_(tree), target_(target), magnitude_(magnitude), bounds_(bounds), counters_(counters) {}

    // Lowers the upper bound by h(T, S) of one triangle S of B.
    void bound_by(ListedPiece& piece, Index triangle);

    // Computes the unknown corner distances of a piece, its upper bound, and the candidates for its list by group
    // traversal: the three corners go through B together, and each leaf is measured against all of them.
    void cull(ListedPiece& piece);

    // Computes the corner distances and the upper bound of a piece by closest point queries, one for each corner.
    // `warm`: a triangle of B to try first, or -1.
    void measure_corners(ListedPiece& piece, Index warm);

    // Gives the piece the list of the triangles that may be nearest to one of its points, or none if there are too
    // many. Call it after cull() or part() of the piece.
    void list(ListedPiece& piece);

    // Measures the vertices of a cut of the piece against its list, which is released, or without a list against the
    // triangles nearest to the vertices. Unmeasured new vertices get their nearest triangle from the list.
    void measure(const ListedPiece& piece, Cut<MeasuredPoint>& cut);

    // Returns part c of the piece measured last, bounded by the same triangles.
    ListedPiece part(const ListedPiece& piece, const Cut<MeasuredPoint>& cut, std::size_t c, int level);

    // Releases the list of a piece that is settled without a cut.
    void give_back(const ListedPiece& piece) { lists_.give_back(piece.list); }

    // Returns the number of triangles of B that whole triangles of A were measured against.
    std::uint64_t measured() const { return measured_; }

private:
    // Triangles of B and their squared distances to the vertices of a cut.
    struct Candidates {
        std::array<Index, most_listed> triangle;
        std::array<BlockFeet, most_listed> feet;
        std::size_t count = 0;

        void add(Index one) { triangle[count++] = one; }
    };

    void find_candidates(const ListedPiece& piece, const Cut<MeasuredPoint>& cut);
    template <class Visit>
    void near_triangles(const ListedPiece& piece, const double& search_radius, const Visit& visit);
    double slack(int level) const { return (32 + 8 * level) * unit_roundoff * magnitude_; }
    double radius_at_most(const ListedPiece& piece) const;

    const Tree& tree_;
    const Target& target_;
    double magnitude_;
    SearchBounds& bounds_;
    Counters& counters_;
    Lists lists_;
    std::vector<NearTriangle> near_;  // triangles that may be nearest to a point of a piece
    Candidates candidates_;
    std::uint64_t measured_ = 0;
};

}  // namespace hausbench
