// Lemma 4 of Tang et al. 2009, corrected. If B is closed and a translation D moves a piece T of A through the surface
// of B, then no point of T is farther from B than |D|.
//
// The lemma as printed requires only that B encloses T + D. This is wrong if a part of T is inside B already: a point
// there may stay inside and never meet B. Here, three conditions are required instead:
//
// 1. B is closed: every edge of B belongs to an even number of its triangles.
// 2. Neither T nor T + D touches B.
// 3. For one point p of T, the segment from p to p + D crosses B an odd number of times.
//
// Proof: let p move continuously to any other point of T. By 2, neither end of its segment ever meets B. So, because
// B is closed, crossings appear and vanish two at a time, and the number of crossings stays odd. So the segment from
// every point of T meets B, and its length is |D|. It does not matter whether T + D is inside B and T outside, or the
// reverse.
//
// Certified: condition 2 is proven by an axis that separates T, and one that separates T + D, from each triangle of B.
// Condition 3 is proven by such axes and by the signs of determinants. Both proofs hold under rounding; if rounding
// leaves one of them undecided, no bound is given.
//
// Rounding, with u and M as in kernel/rounding.h, and N = M + |D|.
//
// The lemma is about exact points, but the axes separate the computed corners of T and of T + D from B:
// - T stands for an exact piece within 2k uM of it, where k is its level.
// - Adding D to a corner errs by uN in each coordinate, so by less than 2uN in length.
// - The computed p is within 7uM of T. Its weights and products err by uM together and the sums by 1.8uM, so each
//   coordinate errs by less than 3uM, and sqrt(3) * 3uM < 7uM.
// Together, all exact points are within (2k + 2 + 7) uN of the hull of the computed corners of T or of T + D. So each
// of these hulls must be more than (2k + 9) uN away from each triangle of B.
//
// The distance between a hull and a triangle of B along an axis n is computed:
// - The coordinates of n are at most 1, so |n| <= sqrt(3), and a length l becomes at most sqrt(3) * l along n.
// - A computed product n.x errs by 3.01u (|n_1| + |n_2| + |n_3|) N <= 9.1uN, two of them by 18.2uN, and the difference
//   of two products by u of itself.
// So the computed distance must exceed sqrt(3) (2k + 9) uN + 18.2uN. The margin in upper() is (4k + 48) uN; the rest
// of it covers the rounding of the difference and of the margin itself.
#pragma once

#include "algorithms/meshes/tang/volumes.h"
#include "algorithms/search/piece_bounds.h"

namespace hausbench::tang {

// Returns whether every edge belongs to an even number of triangles. Edges are compared by vertex index, as in
// Adjacency.
bool is_closed(const TriangleMesh& mesh);

// Returns the sign of det(a - d, b - d, c - d), which says on which side of the plane abc the point d lies. Returns 0
// if rounding errors could change the sign.
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

// Bounds the distances from a piece of A to B by moving the piece through the surface of B, as the lemma above allows.
template <class Tree> class EnclosedMove {
public:
    // Keeps the references. `tree` is a BVH of B, which must be closed. `magnitude` is the largest |coordinate| of A
    // and B (M in kernel/rounding.h).
    EnclosedMove(const Tree& tree, const Target& target, double magnitude, Counters& counters)
        : tree_(tree), target_(target), magnitude_(magnitude), counters_(counters) {}

    // Moves the piece by `length`, so that its corner farthest from B moves towards the closest point on B. If the
    // lemma above applies, no point of the piece is farther than `length` from B, so returns `length`, rounded up.
    // Returns infinity otherwise. `level` is the rounding level of the piece (kernel/rounding.h).
    double upper(const PieceCorners& corners, int level, double length);

    // Like upper() above, but moves the piece by the vector `move`.
    double upper(const std::array<Vec3, 3>& corners, int level, const Vec3& move);

private:
    const Tree& tree_;
    const Target& target_;
    double magnitude_;
    Counters& counters_;
};

}  // namespace hausbench::tang
