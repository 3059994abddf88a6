// Skips groups of triangles of A that cannot contain the point farthest from B, without examining these triangles one
// by one. A *region* is a node or leaf of a tree over A: its triangles and the box around them. After Zheng et al. 2022
// (with a BVH), and after descriptions of Guthe et al. 2005 (with an octree).
//
// The upper bound of a region is the distance from a point q of B to the corner of the box that is farthest from q: no
// point of the box is farther from q than this corner, and B is at least as near as q. q is the point of B nearest to
// the centre of the box, or of a larger box that contains it. Finding a new q takes a closest point query, which pays
// only if the box is so small, compared with the lower bound, that the region may be skipped. So the query waits until
// the region is taken from the queue, which returns the region with the largest bound first.
//
// Rounding: the box contains the vertices of A as computed for the pose, so it contains the triangles between them
// (kernel/posed_box.h). The computed q is within 7uM of B, where u = 2^-53 and M is the largest |coordinate|. The
// distance from q to a corner has the same rounding error as the distance from a vertex to B, so the bound is widened
// by as much (kernel/rounding.h, level 0).
#pragma once

#include "algorithms/kernel/posed_box.h"
#include "algorithms/search/bounds.h"
#include "algorithms/structures/triangle_tree.h"

#include <functional>

namespace hausbench {

class SourceRegions {
public:
    // Keeps references to all arguments except `points`. `tree` is over A in its own coordinates; `points` are the
    // vertices of A, moved by its pose. O(n), to find the box around the points.
    SourceRegions(const TriangleTree& tree, const Points& points, const Pose& pose, const Target& target,
                  SearchBounds& bounds, Counters& counters)
        : tree_(tree.tree()),
          pose_(pose),
          all_(box_of(points)),
          target_(target),
          bounds_(bounds),
          counters_(counters) {}

    // Calls one of two functions once for every triangle of A:
    // - settle(triangle, upper, shown) if the triangle can be skipped: none of its points is farther than `upper` from
    //   triangle `shown` of B, and `upper` is at most bounds.purged_at_most(0);
    // - look(triangle, near) if it must be examined. `near` is a triangle of B near it, or -1 if none is known. `look`
    //   may pass points to bounds.offer(), which raises the lower bound, so that later regions can be skipped.
    // Returns false if time runs out.
    bool walk(const std::function<void(Index triangle, Index near)>& look,
              const std::function<void(Index triangle, double upper, Index shown)>& settle);

private:
    struct Region {
        double upper;
        Box box;             // around its triangles, moved by the pose of A
        Vec3 q;              // the point of B from which `upper` is measured
        Index near;          // the triangle of B that contains q; -1: q is not set yet
        Index shown;         // the triangle of B that is within `upper` of every point of the box; -1: none yet
        std::int32_t child;  // the node or leaf, as in WideNode
        bool centred;        // whether q was found for the centre of this box, not of a larger one
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
