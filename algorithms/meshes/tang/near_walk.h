// Visits the leaves of a BVH near a given point. Works with both kinds of BVH in volumes.h.
#pragma once

#include "algorithms/kernel/counters.h"
#include "algorithms/meshes/tang/volumes.h"

namespace hausbench::tang {

// Calls leaf(number) for every leaf whose bounding volume may be within `radius` of `centre`. Walks depth first, and to
// the nearest child of each node first. leaf() may lower the variable that `radius` refers to, which shortens the walk;
// a negative value ends it.
template <class Tree, class Leaf>
void visit_near_leaves(const Tree& tree, const Vec3& centre, const double& radius, Counters& counters,
                       const Leaf& leaf) {
    struct Entry {
        double distance;
        std::int32_t child;
    };
    // Each level of the tree leaves at most tree_width - 1 siblings on the stack.
    std::array<Entry, (tree_width - 1) * most_tree_levels + 1> stack;
    std::size_t size = 0;
    stack[size++] = {0, 0};
    while (size > 0) {
        const Entry next = stack[--size];
        if (next.distance > radius) continue;
        if (next.child < 0) {
            leaf(static_cast<std::size_t>(~next.child));
            continue;
        }
        const auto node = static_cast<std::size_t>(next.child);
        const WideNode& wide = tree.tree().nodes[node];
        counters.node_visits += static_cast<std::uint64_t>(wide.count);
        const std::size_t base = size;
        for (int c = 0; c < wide.count; ++c) {
            const double distance = distance_at_least(tree, node, c, centre);
            if (distance > radius) continue;
            std::size_t place = size++;
            for (; place > base && stack[place - 1].distance < distance; --place) stack[place] = stack[place - 1];
            stack[place] = {distance, wide.child[c]};
        }
    }
}

}  // namespace hausbench::tang
