// Culling on B (Tang et al. 2009, section 4.2): a triangle T of A goes through a BVH of B; a node farther from T than T's upper bound u
// is left out. What remains gives the distances of T's corners and u = the least h(T, S) over the triangles S of B (Eqs. 10, 11), and
// the list L of the triangles S that are near enough to bound the parts of T too (Lemma 3).
//
// L: a piece T with corners v_i keeps S only if d(v_i, S) <= u + e_i for all i, e_i the longest edge at v_i. Let S be nearest to some
// p of T. Then d(p, S) <= h(T, B) <= u and |v_i - p| <= e_i, so S stays. Rounding: T stands for an exact piece within 2k uM of it, k
// its level (kernel/rounding.h), so e_i may be 6k uM too small; and a computed distance may be 10uM too large, as measured, and 4u
// of itself. (32 + 8k) uM is added, and 8u of the sum. No bound rests on it: h(T, S) is an upper bound whatever S is, and the
// farthest point is measured again against all of B. Were S missing, the search might end with `precision_floor`.
// A list of more than `most_listed` triangles is not kept: such a piece is measured by closest point queries, and its parts are
// given another chance when they are small enough for a list to be likely. So a piece takes the same memory whatever B is,
// duplicates and the centre of a sphere too.
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

// Triangles of B: in a list, before filtering.
inline constexpr std::size_t most_listed = 32, most_near = 128;

using Lists = ShortLists<most_listed>;

// A triangle of A, or a part of one.
struct ListedPiece {
    PieceCorners corners;
    double upper = std::numeric_limits<double>::infinity();
    Index source = -1;        // triangle of A
    Index best = -1;          // triangle of B whose bound was least
    int level = 0;            // of rounding
    int depth = 0;            // how often its triangle was subdivided
    Lists::List list;         // empty: there is none
    std::uint64_t crowd = 0;  // triangles of B that seem to be near, where there is no list
};

// A triangle of B, and its squared distance to each corner of a piece.
struct NearTriangle {
    Index triangle;
    std::array<double, 3> squared;
};

template <class Tree> class TargetCulling {
public:
    // References are kept. `tree` is over B.
    TargetCulling(const Tree& tree, const Target& target, double magnitude, SearchBounds& bounds, Counters& counters)
        : tree_(tree), target_(target), magnitude_(magnitude), bounds_(bounds), counters_(counters) {}

    // Lowers the upper bound by h(T, S) of one triangle S of B.
    void bound_by(ListedPiece& piece, Index triangle);

    // Finds the unknown distances of its corners, its upper bound, and its list. In group traversal the three corners
    // go through B together, and a leaf is measured against all of them.
    void cull(ListedPiece& piece);

    // Its corners and its upper bound, each corner by itself: a closest point query, which looks at triangle `warm` first.
    void measure_corners(ListedPiece& piece, Index warm);

    // Gives the piece the list of what may be nearest to one of its points; none if that is too much. After cull() or part() of it.
    void list(ListedPiece& piece);

    // Measures the vertices of a cut of the piece against its list, which is returned, or without a list against the
    // triangles nearest to them. New vertices that were not measured yet are nearest to one of the list.
    void measure(const ListedPiece& piece, Cut<MeasuredPoint>& cut);

    // Part c of the piece that was measured last, bounded by the same triangles.
    ListedPiece part(const ListedPiece& piece, const Cut<MeasuredPoint>& cut, std::size_t c, int level);

    // The room of its list, where it is settled without a cut.
    void give_back(const ListedPiece& piece) { lists_.give_back(piece.list); }

    // The triangles of B that whole triangles of A were measured against.
    std::uint64_t measured() const { return measured_; }

private:
    // Triangles of B, and their squared distances to the vertices of a piece that is cut.
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
    std::vector<NearTriangle> near_;  // what may be nearest to a point of a piece
    Candidates candidates_;
    std::uint64_t measured_ = 0;
};

}  // namespace hausbench
