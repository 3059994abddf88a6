// Culling on A (Tang et al. 2009, section 4.1). Searches a BVH of A from its root and skips all triangles below a
// node if some point q of B is within the lower bound of its whole volume (Eqs. 8, 9).
//
// Ours: nodes with the largest upper bound come first; q is the point of B closest to the middle of the volume or of
// an enclosing one. q is queried only if it can cull. In a chain of poses (also ours), the triangle of B nearest to a
// volume at the previous pose gives q without a query.
#pragma once

#include "algorithms/meshes/tang/volumes.h"
#include "algorithms/search/bounds.h"

#include <span>
#include <vector>

namespace hausbench {

// `Tree` is SweptSphereBvh or TriangleBvh, over A unposed; its volumes are moved with A. Culled nodes are settled in
// `bounds`, and so are their triangles if `bounds` keeps elements.
template <class Tree> class SourceCulling {
public:
    // Keeps references. `near_node` as in WarmStart, read and written; it may be null.
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

    bool done() const { return branches_.empty(); }

    // Returns the largest upper bound of the remaining nodes, 0 if none is left.
    double upper() const { return branches_.empty() ? 0 : branches_.back().rest; }

    // Takes one node and culls it or replaces it by its children. If it is an uncullable leaf, returns its triangles
    // to the caller.
    std::span<const Index> step();

    // Gives each remaining triangle the bound of its node.
    void settle_elements() const {
        for (const Branch& branch : branches_) settle_below(branch.child, branch.upper);
    }

private:
    // A node or a leaf.
    struct Branch {
        double upper;       // bound of everything below it
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
    std::vector<Branch> branches_;  // the remaining ones, the largest bound last
};

}  // namespace hausbench
