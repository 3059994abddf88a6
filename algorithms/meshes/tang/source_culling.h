// Culling on A (Tang et al. 2009, section 4.1). Walks down a BVH of A. The upper bound of a node is the largest
// distance from some point q of B to a point of the node's bounding volume (Eqs. 8, 9), so no triangle below the node
// has a point that is farther from B than this. If the upper bound is at most the lower bound of h(A,B) so far, the
// node and all triangles below it are culled.
//
// Not in the paper: the child with the largest upper bound is visited first. The q of the parent is tried first; if it
// does not cull the node, a query finds the point of B closest to the centre of the volume. A leaf whose volume is so
// large that no q can cull it gets no query. In a chain of nearby poses, one more q is tried before the query: the
// closest point on the triangle of B that was nearest to the same volume at the previous pose.
#pragma once

#include "algorithms/kernel/watched.h"
#include "algorithms/meshes/tang/volumes.h"
#include "algorithms/search/bounds.h"

#include <span>
#include <vector>

namespace hausbench::tang {

// Walks a BVH of A and culls the nodes that cannot contain the point farthest from B. The BVH is over A before its
// motion, and `pose` moves the bounding volumes. `Tree` is SweptSphereBvh or TriangleBvh.
template <class Tree> class SourceCulling {
public:
    // Keeps the references. `near_node` is null, or has a triangle of B near each node at the previous pose
    // (WarmStart::near_node) and is updated.
    SourceCulling(const Tree& tree, const Pose& pose, const Target& target, double magnitude, SearchBounds& bounds,
                  Counters& counters, std::vector<Index>* near_node)
        : tree_(tree),
          pose_(pose),
          target_(target),
          magnitude_(magnitude),
          bounds_(bounds),
          counters_(counters),
          near_node_(near_node) {
        if (near_node) near_node->resize(tree.tree().nodes.size() + tree.tree().leaves(), -1);
    }

    // Starts the walk at the root. `points` are the vertices of A, moved by its pose. O(n).
    void begin(const Points& points);

    // Returns whether the walk is over: step() has culled or returned every leaf.
    bool done() const { return branches_.empty(); }

    // Returns the largest upper bound of the nodes still to be visited; 0 if there are none.
    double upper() const { return branches_.empty() ? 0 : branches_.back().rest; }

    // Visits one node: culls it or pushes its children. If the node is a leaf that cannot be culled, returns its
    // triangles, for which the caller must compute bounds. Otherwise returns an empty span.
    std::span<const Index> step();

    // Records the upper bound of each node still to be visited for every triangle below it.
    void settle_elements() const {
        for (const Branch& branch : branches_) {
            if (WATCHED("tang: the triangles of what is left of A's tree have a bound", true))
                settle_below(branch.child, branch.upper);
        }
    }

private:
    // A node or a leaf on the stack `branches_`.
    struct Branch {
        double upper;        // upper bound on the distance to B of everything below it
        double rest;         // the largest `upper` of this branch and all branches under it on the stack
        ClosestPoint near;   // a point of B near the volume; tried first for its children
        std::int32_t child;  // as in WideNode: >= 0: a node; negative: ~(leaf number)
    };

    void expand(const Branch& branch);
    Branch bounded_child(const Branch& branch, std::size_t node, int child);
    Index* near_of(std::int32_t child) const;
    void settle_below(std::int32_t child, double upper) const;

    const Tree& tree_;
    VolumePose pose_;
    const Target& target_;
    double magnitude_;
    SearchBounds& bounds_;
    Counters& counters_;
    std::vector<Index>* near_node_;
    // The nodes still to be visited. Children are pushed in the order of their upper bounds, the largest last.
    std::vector<Branch> branches_;
};

}  // namespace hausbench::tang
