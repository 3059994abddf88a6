// Lemma 4 of Tang et al. 2009, corrected: bounds a piece T of A by a translation D of T, if B is closed.
//
// As printed: if B encloses T + D, then no point of T is farther from B than |D|. This is wrong if part of T is
// inside B, because a point inside may stay inside without meeting B.
// Here: let every edge of B belong to an even number of its triangles, and let neither T nor T + D touch B. If the
// segment from one point p of T to p + D crosses B an odd number of times, then so does the segment of every other
// point of T: when p moves to that point, neither end of the segment meets B, so the number of crossings changes by
// two at a time, because B is closed modulo 2. So each segment meets B, and no point of T is farther from B than |D|.
// T may also be inside and T + D outside.
//
// Certified: an axis separates T and T + D from each triangle of B, and orientations count the crossings. Both are
// proven under rounding; if either is in doubt, there is no bound.
//
// Rounding: T stands for an exact piece within 2k uM of it, where k is its level (kernel/rounding.h). Adding D to a
// corner errs by u N in each coordinate, less than 2u N in length, where N = M + |D|. p is within 7uM of T: weights
// and products err by u M together, the sums by 1.8uM, so each coordinate errs by less than 3uM. So the exact points
// are within (2k + 9) uN of the computed corners, which must be that far from B. An axis n has coordinates of at most
// 1, so lengths along it are at most sqrt(3) times as long; a computed product n.x errs by 3.01u (|n_1| + |n_2| +
// |n_3|) N <= 9.1uN, two of them by 18.2uN, and their difference by u of itself. (4k + 48) uN exceeds sqrt(3) (2k +
// 9) uN + 18.2uN plus the rounding of that difference and of this product.
#pragma once

#include "algorithms/meshes/tang/volumes.h"
#include "algorithms/search/piece_bounds.h"

namespace hausbench {

// Returns whether every edge, as a pair of vertex numbers, belongs to an even number of triangles. O(n).
bool is_closed(const TriangleMesh& mesh);

// Returns the sign of det(a - d, b - d, c - d); 0 if rounding leaves it undecided.
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

template <class Tree> class EnclosedMove {
public:
    // Keeps references. `tree` is over B, which must be closed.
    EnclosedMove(const Tree& tree, const Target& target, double magnitude, Counters& counters)
        : tree_(tree), target_(target), magnitude_(magnitude), counters_(counters) {}

    // Returns an upper bound of h(T, B) by moving T by `length` from its corner farthest from B towards that corner's
    // closest point on B; infinity if the lemma does not apply.
    double upper(const PieceCorners& corners, int level, double length);

    // Does the same for a given move.
    double upper(const std::array<Vec3, 3>& corners, int level, const Vec3& move);

private:
    const Tree& tree_;
    const Target& target_;
    double magnitude_;
    Counters& counters_;
};

}  // namespace hausbench
