// Settles groups of triangles of A by the boxes of a tree over A: a group that cannot hold the farthest point is settled without
// examining its triangles. After Zheng et al. 2022 (a BVH), and descriptions of Guthe et al. 2005 (an octree: only regions that can
// attain the maximum are examined).
//
// The distance of a box to B is at most the distance of its farthest corner to a point q of B. q is the point of B nearest to the centre
// of the box, or of an enclosing box. A query for q pays only if the box is small compared with the lower bound, so that its group
// can be settled; so it is made when the group is taken from the queue, largest bound first.
//
// Rounding: the box contains the posed vertices as computed, and so their triangles (kernel/posed_box.h). q is within 7uM of B, and its
// distance to a corner errs like the distance of a vertex, so the bound is widened like the bound of a vertex (kernel/rounding.h).
#pragma once

#include "algorithms/kernel/posed_box.h"
#include "algorithms/search/bounds.h"
#include "algorithms/structures/triangle_tree.h"

#include <functional>

namespace hausbench {

class SourceRegions {
public:
    // Keeps references. `tree` is over A in its own coordinates, `points` are its posed vertices. O(n) for their box.
    SourceRegions(const TriangleTree& tree, const Points& points, const Pose& pose, const Target& target,
                  SearchBounds& bounds, Counters& counters)
        : tree_(tree.tree()),
          pose_(pose),
          all_(box_of(points)),
          target_(target),
          bounds_(bounds),
          counters_(counters) {}

    // Calls one of the two functions once for every triangle of A: `settle` with its upper bound (at most
    // bounds.purged_at_most(0)) and a triangle of B that is within this bound of every point of it, or `look` with
    // a triangle of B that is near, or -1. `look` may offer points to the bounds. Returns false if time runs out.
    bool walk(const std::function<void(Index triangle, Index near)>& look,
              const std::function<void(Index triangle, double upper, Index shown)>& settle);

private:
    struct Region {
        double upper;
        Box box;             // posed
        Vec3 q;              // a point of B
        Index near;          // the triangle of q; -1: unknown
        Index shown;         // triangle of B at distance `upper`; -1: none yet
        std::int32_t child;  // as in WideNode
        bool own;            // whether q is nearest to the centre of this box
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
