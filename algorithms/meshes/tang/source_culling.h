// Culling on A (Tang et al. 2009, section 4.1). Walks down a BVH of A. The upper bound of a node is the largest
// distance from some point q of B to a point of the node's volume (Eqs. 8, 9), so no triangle below the node has a
// point that is farther from B than this. If the upper bound is at most the lower bound of h(A,B) so far, the node and
// all triangles below it are culled.
//
// Ours: of the children of a node, the one with the largest upper bound comes first. The q of the parent is tried
// first. If it does not cull the node, a query finds the point of B closest to the centre of the volume. A leaf whose
// volume is so large that no q can cull it gets no query. In a chain of poses (also ours), one more q is tried before
// the query: the closest point on the triangle of B that was nearest to the same volume at the previous pose.
#pragma once

#include "algorithms/meshes/tang/volumes.h"
#include "algorithms/search/bounds.h"

#include <span>
#include <vector>

namespace hausbench {

// `Tree` is SweptSphereBvh or TriangleBvh. The tree is over A unposed; `pose` moves its volumes. The upper bounds of
// culled nodes are recorded in `bounds`, and also the bound of each triangle below them if `bounds` keeps such bounds
// (SearchBounds::elements() is not null).
template <class Tree> class SourceCulling {
public:
    // Keeps references. `near_node` is WarmStart::near_node, which is used and updated, or null.
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

    // Starts at the root. `points` are the vertices of A, posed. O(n).
    void begin(const Points& points);

    // Returns whether no node remains: each was culled, or was a leaf that step() returned.
    bool done() const { return branches_.empty(); }

    // Returns the largest upper bound of the remaining nodes, 0 if none is left.
    double upper() const { return branches_.empty() ? 0 : branches_.back().rest; }

    // Takes one node: culls it, or replaces it with its children. If the node is a leaf that cannot be culled, returns
    // its triangles, and the caller must bound them; otherwise returns an empty span.
    std::span<const Index> step();

    // Records the upper bound of each remaining node for the triangles below it.
    void settle_elements() const {
        for (const Branch& branch : branches_) settle_below(branch.child, branch.upper);
    }

private:
    // A node or a leaf on the stack `branches_`.
    struct Branch {
        double upper;        // upper bound on the distance to B of everything below it
        double rest;         // the largest `upper` of this branch and all branches under it on the stack
        ClosestPoint near;   // the point q of B
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
    // A stack of the remaining nodes. The children of one node lie together, the child with the largest bound on top.
    std::vector<Branch> branches_;
};

}  // namespace hausbench
