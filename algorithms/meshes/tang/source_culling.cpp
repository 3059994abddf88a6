#include "algorithms/meshes/tang/source_culling.h"

#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace hausbench::tang {

// Bounds the root by the largest distance from a vertex of A to a single point of B, the one closest to the first
// vertex.
template <class Tree> void SourceCulling<Tree>::begin(const Points& points) {
    const ClosestPoint first = target_.closest(points.row(0), -1, counters_);
    double most = 0;
    for (Index v = 0; v < points.rows(); ++v) most = std::max(most, squared_length(Vec3(points.row(v)) - first.point));
    const double upper =
        WATCHED_ELSE("tang: the bound of all of A is widened", bounds_.at_most(most, 0), std::sqrt(most));
    branches_.push_back({upper, upper, first, 0});
}

template <class Tree> std::span<const Index> SourceCulling<Tree>::step() {
    const Branch branch = branches_.back();
    branches_.pop_back();
    if (branch.upper <= bounds_.purged_at_most(0)) {
        if (WATCHED("tang: a culled node counts", true)) bounds_.settle(branch.upper, 0, 0, 1);
        if (WATCHED("tang: the triangles of a culled node have its bound", true))
            settle_below(branch.child, branch.upper);
    } else if (branch.child >= 0) {
        expand(branch);
    } else {
        return tree_.tree().leaf(static_cast<std::size_t>(~branch.child));
    }
    return {};
}

// Returns a child with its upper bound: the largest distance from a point of its bounding volume to some point q of B.
// A computed q is only within 7uM of B (kernel/point_triangle.h), where u = 2^-53 and M is the largest |coordinate| of
// A and B. So 8uM is added; next_up absorbs the rounding of this sum.
template <class Tree>
typename SourceCulling<Tree>::Branch SourceCulling<Tree>::bounded_child(const Branch& branch, std::size_t node,
                                                                        int child) {
    const CornerVolume volume = WATCHED_ELSE("tang: A's volumes are moved with it",
                                             pose_(corners_of(tree_, node, child)), corners_of(tree_, node, child));
    const auto bound = [&](const Vec3& q) {
        ++counters_.bound_tests;
        return next_up(distance_at_most(volume, q) +
                       WATCHED("tang: a node's bound is widened by what q may be off", 8 * unit_roundoff * magnitude_));
    };
    Branch result{std::min(branch.upper, bound(branch.near.point)), 0, branch.near,
                  tree_.tree().nodes[node].child[child]};
    // For any point of B, the bound is at least half the diagonal of the volume (`size`) plus its radius. If this is
    // too much to cull a leaf, a better point is useless. An inner node gets one nevertheless, because its children
    // inherit it.
    const double purged = bounds_.purged_at_most(0);
    const double size = 0.5 * std::sqrt(squared_length(volume.corner[0] - volume.corner[volume.count - 1]));
    const auto may_cull = [&] { return result.upper > purged && (result.child >= 0 || size + volume.radius < purged); };
    Index* const last = near_of(result.child);
    if (last && *last >= 0 && may_cull()) {
        const TrianglePoint near = closest_point(volume.centre(), target_.triangle(*last));
        ++counters_.point_triangle_distances;
        result.near = {near.squared_distance, near.point, *last};
        result.upper = std::min(result.upper, WATCHED_ELSE("culling on A: the point of a triangle that was near before",
                                                           bound(near.point), bound(volume.centre())));
    }
    if (may_cull()) {
        result.near = target_.closest(volume.centre(), result.near.triangle, counters_);
        result.upper = std::min(result.upper, bound(result.near.point));
        if (last) *last = result.near.triangle;
    }
    return result;
}

template <class Tree> Index* SourceCulling<Tree>::near_of(std::int32_t child) const {
    if (!near_node_) return nullptr;
    const std::size_t nodes = tree_.tree().nodes.size();
    const std::size_t i = child >= 0 ? static_cast<std::size_t>(child) : nodes + static_cast<std::size_t>(~child);
    return &(*near_node_)[i];
}

// Pushes the children of a node, the child with the largest upper bound last.
template <class Tree> void SourceCulling<Tree>::expand(const Branch& branch) {
    const auto node = static_cast<std::size_t>(branch.child);
    const int count = tree_.tree().nodes[node].count;
    counters_.node_visits += static_cast<std::uint64_t>(count);
    std::array<Branch, tree_width> sorted;
    for (int c = 0; c < count; ++c) {
        const Branch child = bounded_child(branch, node, c);
        auto place = static_cast<std::size_t>(c);
        for (; place > 0 && sorted[place - 1].upper > child.upper; --place) sorted[place] = sorted[place - 1];
        sorted[place] = child;
    }
    for (std::size_t c = 0; c < static_cast<std::size_t>(count); ++c) {
        sorted[c].rest = std::max(sorted[c].upper, WATCHED("tang: what is below on the stack counts", upper()));
        branches_.push_back(sorted[c]);
    }
}

template <class Tree> void SourceCulling<Tree>::settle_below(std::int32_t child, double upper) const {
    ElementBounds* elements = bounds_.elements();
    if (!elements) return;
    if (child < 0) {
        for (const Index i : tree_.tree().leaf(static_cast<std::size_t>(~child))) elements->settle(upper, i);
        return;
    }
    const WideNode& node = tree_.tree().nodes[static_cast<std::size_t>(child)];
    for (int c = 0; c < node.count; ++c) settle_below(node.child[c], upper);
}

template class SourceCulling<SweptSphereBvh>;
template class SourceCulling<TriangleBvh>;

}  // namespace hausbench::tang
