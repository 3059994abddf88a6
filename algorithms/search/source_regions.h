// Settles whole groups of triangles of A (bounds.h). A *region* is a node or leaf of a tree over A: the triangles in it
// and the box around them. If no point of a region can be the farthest point, its triangles are settled without being
// examined one by one. After Zheng et al. 2022 (with a BVH), and after descriptions of Guthe et al. 2005 (with an
// octree, where only regions that can attain the maximum are examined).
//
// The upper bound of a region is the distance from a point q of B to the corner of the box that is farthest from q: no
// point of the box is farther from q than this corner, and B is at least as near as q. q is the point of B nearest to
// the centre of the box, or of a larger box that contains it. To find a new q takes a closest point query, which is
// worth its cost only if the box is small compared with the lower bound, so that it may settle the region. The query is
// therefore postponed until the region is taken from the queue, which returns the region with the largest bound first.
//
// Rounding: the box contains the vertices of A as computed for the pose, and so the triangles between them
// (kernel/posed_box.h). q as computed is within 7uM of B, and its distance to a corner errs like the distance of a
// vertex to B, so the bound is widened like the bound of a vertex (kernel/rounding.h, which defines u and M).
#pragma once

#include "algorithms/kernel/posed_box.h"
#include "algorithms/search/bounds.h"
#include "algorithms/structures/triangle_tree.h"

#include <functional>

namespace hausbench {

class SourceRegions {
public:
    // Keeps references to all arguments but `points`. `tree` is over A in its own coordinates; `points` are the
    // vertices of A, moved by its pose. O(n), to find the box around them.
    SourceRegions(const TriangleTree& tree, const Points& points, const Pose& pose, const Target& target,
                  SearchBounds& bounds, Counters& counters)
        : tree_(tree.tree()),
          pose_(pose),
          all_(box_of(points)),
          target_(target),
          bounds_(bounds),
          counters_(counters) {}

    // Calls one of the two functions once for every triangle of A:
    // - settle(triangle, upper, shown) if its region is settled: no point of the triangle is farther than `upper` from
    //   triangle `shown` of B, and `upper` is at most bounds.purged_at_most(0);
    // - look(triangle, near) otherwise, where `near` is a triangle of B that is near it, or -1. `look` may offer points
    //   to the bounds, which raises the lower bound and lets later regions be settled.
    // Returns false if time runs out.
    bool walk(const std::function<void(Index triangle, Index near)>& look,
              const std::function<void(Index triangle, double upper, Index shown)>& settle);

private:
    struct Region {
        double upper;
        Box box;             // around its triangles, which are moved by the pose of A
        Vec3 q;              // a point of B, see the file comment
        Index near;          // the triangle of B that contains q; -1: q is not set yet
        Index shown;         // a triangle of B with no point of the box farther than `upper` from it; -1: none yet
        std::int32_t child;  // the node or leaf, as in WideNode
        bool own;            // whether q is nearest to the centre of this box, not of a larger one
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
