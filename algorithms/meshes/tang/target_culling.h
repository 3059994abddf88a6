// Culling on B (Tang et al. 2009, section 4.2). Takes a triangle T of A through a BVH of B and skips the nodes that are
// farther from T than the upper bound on h(T, B) so far. The triangles S of B in the other nodes give
//
// - the distances of T's corners from B,
// - an upper bound on h(T, B): the least h(T, S) (Eqs. 10, 11),
// - the list of T: the triangles S that are so near that they may be the nearest ones to some point of T (Lemma 3).
//
// When T is cut, its list replaces B for the pieces.
//
// Which triangles a list contains: let a piece T have the corners v_i, let e_i be the longest edge at v_i, and let
// `upper` be the upper bound on h(T, B). S is in the list if d(v_i, S) <= upper + e_i for each i. No triangle that is
// nearest to a point p of T is missing: for such an S, d(p, S) <= h(T, B) <= upper and |v_i - p| <= e_i, so d(v_i, S)
// <= upper + e_i.
//
// Rounding, with u and M as in kernel/rounding.h: T stands for an exact piece within 2k uM of it, where k is its level,
// so e_i may be too small by 6k uM. A computed distance may be too large by 10uM, as measured in tests
// (kernel/point_triangle.h), and by 4u of itself. So (32 + 8k) uM is added to upper + e_i, and 8u of the sum. No bound
// depends on this: h(T, S) is an upper bound for any S, and the farthest point is measured again against all of B. If a
// triangle were missing from a list, the search might end with `precision_floor`, but its bounds would hold.
//
// If more than `most_listed` triangles qualify, the piece has no list, and its new vertices cost closest point queries.
// Its parts try again to get a list once they are so small that success is likely (ListedPiece::crowd). So the memory
// for a piece does not depend on B, even if B has many equal triangles, or if B is a sphere and a corner is at its
// centre.
#pragma once

#include "algorithms/meshes/tang/short_lists.h"
#include "algorithms/meshes/tang/volumes.h"
#include "algorithms/search/bounds.h"
#include "algorithms/search/piece_bounds.h"
#include "algorithms/search/subdivision.h"

#include <array>
#include <limits>
#include <vector>

namespace hausbench::tang {

// The largest number of triangles of B in a list, and the largest number of candidates from which a list is chosen.
inline constexpr std::size_t most_listed = 32, most_near = 128;

using Lists = ShortLists<most_listed>;

// A triangle of A or a part cut from it, with its upper bound and its list of near triangles of B.
struct ListedPiece {
    PieceCorners corners;
    double upper = std::numeric_limits<double>::infinity();  // upper bound on the distances of its points from B
    Index source = -1;                                       // its triangle of A
    Index best = -1;  // the triangle S of B with the least h(T, S) of those tried; -1: none yet
    // Rounding level: how far rounding may have moved the corners off A (kernel/rounding.h). 0 for a whole triangle.
    int level = 0;
    int depth = 0;     // number of cuts that led to it; 0: a whole triangle
    Lists::List list;  // triangles of B; empty: it has no list
    // For a piece without a list: the estimated number of triangles of B near it. No list is tried while this is above
    // most_near.
    std::uint64_t crowd = 0;
};

// A triangle of B with its squared distances from the corners of a piece.
struct NearTriangle {
    Index triangle;
    std::array<double, 3> squared;
};

// Searches B for the triangles near a piece of A, computes the upper bound and the corner distances of the piece, and
// stores its list.
template <class Tree> class TargetCulling {
public:
    // Keeps references. `tree` is over B.
    TargetCulling(const Tree& tree, const Target& target, double magnitude, SearchBounds& bounds, Counters& counters)
        : tree_(tree), target_(target), magnitude_(magnitude), bounds_(bounds), counters_(counters) {}

    // Lowers the upper bound of a piece to its largest distance from the given triangle of B, if that is less.
    void bound_by(ListedPiece& piece, Index triangle);

    // Walks the BVH of B once for all three corners of a piece (group traversal in the paper). Lowers the upper bound
    // of the piece, computes the corner distances that are not known yet, and collects the candidates for its list.
    void cull(ListedPiece& piece);

    // Like cull(), but with one closest point query for each corner whose distance is not known, and without candidates
    // for a list. `warm` is a triangle of B to try first, or -1.
    void measure_corners(ListedPiece& piece, Index warm);

    // Chooses the list of a piece from the candidates that cull() or part() found. Call it directly after one of these,
    // with the same piece. The piece gets no list if too many triangles qualify.
    void list(ListedPiece& piece);

    // Computes the distances from all vertices of a cut piece to each triangle in its list, and releases the list. Each
    // new vertex gets the least of its distances. If the piece has no list, uses the triangles nearest to the vertices
    // instead, so all vertices must have their distances to B.
    void measure(const ListedPiece& piece, Cut<MeasuredPoint>& cut);

    // Returns part c of a cut piece, with an upper bound from the distances that measure() computed for the same piece
    // and cut. `level` is the rounding level of the part (kernel/rounding.h).
    ListedPiece part(const ListedPiece& piece, const Cut<MeasuredPoint>& cut, std::size_t c, int level);

    // Releases the list of a piece that will not be cut.
    void give_back(const ListedPiece& piece) { lists_.give_back(piece.list); }

    // Returns the number of pairs of a whole triangle of A and a triangle of B whose distances were computed.
    // measure_corners() counts each corner separately.
    std::uint64_t measured() const { return measured_; }

private:
    // Triangles of B with their squared distances from the vertices of a cut.
    struct Candidates {
        std::array<Index, most_listed> triangle;
        std::array<BlockFeet, most_listed> feet;
        std::size_t count = 0;

        void add(Index index) { triangle[count++] = index; }
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
    std::vector<NearTriangle> near_;  // candidates for the list of the piece given to cull() or returned by part()
    Candidates candidates_;           // of the cut given to measure()
    std::uint64_t measured_ = 0;      // see measured()
};

}  // namespace hausbench::tang
