// Groups of triangles of A, by the boxes of a tree over A: a group that cannot hold the farthest point is settled without a look at
// its triangles. Zheng et al. 2022 (a BVH), and as Guthe et al. 2005 is described (an octree: only regions that can attain the
// maximum are looked at).
//
// No point of a box is farther from B than the box's farthest corner is from a point q of B. q is the point of B that is nearest to
// the centre of the box, or to that of a box around it. A query for it is worth its cost only where the box is so small, beside the
// lower bound, that its group can be settled; so it is made when the group is taken from the queue, largest bound first.
//
// Rounding: the box holds the posed vertices as computed, so their triangles too (kernel/posed_box.h); q is within 7uM of B, and its
// distance to a corner, computed as to a point of the box, errs as that does: a bound like that of a vertex (kernel/rounding.h).
#pragma once

#include "algorithms/kernel/posed_box.h"
#include "algorithms/search/bounds.h"
#include "algorithms/structures/triangle_tree.h"

#include <functional>

namespace hausbench {

class SourceRegions {
public:
    // References are kept. `tree` is over A in its own coordinates, `points` are its vertices, posed. O(n) for their box.
    SourceRegions(const TriangleTree& tree, const Points& points, const Pose& pose, const Target& target,
                  SearchBounds& bounds, Counters& counters)
        : tree_(tree.tree()),
          pose_(pose),
          all_(box_of(points)),
          target_(target),
          bounds_(bounds),
          counters_(counters) {}

    // Calls one of the two for every triangle of A, once: `settle` with its upper bound, which is at most bounds.purged_at_most(0), and
    // the triangle of B that all of it is so near to; or `look`, with a triangle of B that is near, or -1. `look` may offer points to the bounds. False: out of time.
    bool walk(const std::function<void(Index triangle, Index near)>& look,
              const std::function<void(Index triangle, double upper, Index shown)>& settle);

private:
    struct Region {
        double upper;
        Box box;             // posed
        Vec3 q;              // of B
        Index near;          // the triangle that q is on; -1: none is known
        Index shown;         // triangle of B at distance `upper`; -1: none yet
        std::int32_t child;  // as WideNode has it
        bool own;            // whether q is nearest to its own centre
    };

    bool improve(Region& region);
    double upper_of(const Box& box, const Vec3& q);
    void lower(Region& region);
    void for_each_triangle(std::int32_t child, const std::function<void(Index)>& call) const;

    const WideTree& tree_;
    const Pose& pose_;
    Box all_;
    const Target& target_;
    SearchBounds& bounds_;
    Counters& counters_;
};

}  // namespace hausbench
