// Culling on A (Tang et al. 2009, section 4.1): a BVH of A is searched from its root, and all triangles below a node are left out if
// its volume is no farther from some point q of B than the lower bound (Eqs. 8, 9).
//
// Ours: nodes whose volume is farthest from B come first; q is the closest point to the middle of a volume, or of one around it. A
// query for it is made only where it can cull. In a chain of poses (ours as well), the triangle of B that was nearest to a volume at the
// pose before gives a q without a query.
#pragma once

#include "algorithms/meshes/tang/volumes.h"
#include "algorithms/search/bounds.h"

#include <span>
#include <vector>

namespace hausbench {

// `Tree`: SweptSphereBvh or TriangleBvh, over A where it stands; its volumes are moved with A. What is culled is settled in
// `bounds`, and so are its triangles where `bounds` keeps elements.
template <class Tree> class SourceCulling {
public:
    // References are kept.
    // `near_node`: as in WarmStart, read and written; or null.
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

    // `points`: the vertices of A, posed. O(n).
    void begin(const Points& points);

    bool done() const { return branches_.empty(); }

    // The largest upper bound of what was not looked at yet, 0 where it is done.
    double upper() const { return branches_.empty() ? 0 : branches_.back().rest; }

    // Takes one node: it is culled, or its children take its place. Or a leaf: its triangles, which are the caller's from now on.
    std::span<const Index> step();

    // Gives each triangle that was not looked at yet the bound of its node.
    void settle_elements() const {
        for (const Branch& branch : branches_) settle_below(branch.child, branch.upper);
    }

private:
    // A node, or a leaf.
    struct Branch {
        double upper;       // bound of all below it
        double rest;        // the largest bound from here down the stack
        ClosestPoint near;  // on B
        std::int32_t child;
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
    std::vector<Branch> branches_;  // what is left, the largest bound last
};

}  // namespace hausbench
