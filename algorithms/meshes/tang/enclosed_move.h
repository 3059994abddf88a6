// Lemma 4 of Tang et al. 2009, corrected: a bound for a piece T of A where B is closed, from a translation D of T.
//
// As printed: if T + D is enclosed by B, then no point of T is farther from B than |D|. That is wrong where T is not all outside B:
// a point of T that is inside may stay inside, without meeting B.
// Here: let every edge of B belong to an even number of its triangles, and let neither T nor T + D touch B. If the segment from one
// point p of T to p + D crosses B an odd number of times, then so does that of each other point: on the way from the one to the
// other neither end meets B, and such a path changes the number of crossings by two at a time, as B is closed modulo 2. So each
// segment meets B, and no point of T is farther from B than |D|. T may as well be inside, and T + D outside.
//
// Certified: T and T + D are kept apart from each triangle of B by an axis, crossings are counted by orientations; both are proven
// under rounding, and where one of them is in doubt there is no bound.
//
// Rounding: T stands for an exact piece within 2k uM of it, k its level (kernel/rounding.h). Adding D to a corner errs by u N in each
// coordinate, less than 2u N in length, N = M + |D|; p is within 7uM of T (weights and products err by u M in all, the sums by 1.8uM:
// less than 3uM in each coordinate). So all that counts is within (2k + 9) uN of the computed corners: that far they must be
// apart from B. An axis n has coordinates of at most 1, so lengths along it are at most sqrt(3) times as long; a computed product
// n.x errs by 3.01u (|n_1| + |n_2| + |n_3|) N <= 9.1uN, two of them by 18.2uN, and their difference by u of itself. (4k + 48) uN is
// more than sqrt(3) (2k + 9) uN + 18.2uN and what that difference and this product lose.
#pragma once

#include "algorithms/meshes/tang/volumes.h"
#include "algorithms/search/piece_bounds.h"

namespace hausbench {

// Whether every edge belongs to an even number of triangles, edges as pairs of vertex numbers. O(n).
bool is_closed(const TriangleMesh& mesh);

// The sign of det(a - d, b - d, c - d); 0 where rounding leaves it open.
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

template <class Tree> class EnclosedMove {
public:
    // References are kept. `tree` is over B, which is closed.
    EnclosedMove(const Tree& tree, const Target& target, double magnitude, Counters& counters)
        : tree_(tree), target_(target), magnitude_(magnitude), counters_(counters) {}

    // An upper bound of h(T, B), for the move by `length` towards the point of B that is nearest to the corner farthest from B; infinity
    // where the lemma says nothing.
    double upper(const PieceCorners& corners, int level, double length);

    // The same for a move that is given.
    double upper(const std::array<Vec3, 3>& corners, int level, const Vec3& move);

private:
    const Tree& tree_;
    const Target& target_;
    double magnitude_;
    Counters& counters_;
};

}  // namespace hausbench
