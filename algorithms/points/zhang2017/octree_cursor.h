// A cursor over the full octree of points, including the levels that PointOctree skips.
#pragma once

#include "algorithms/points/zhang2017/point_octree.h"

namespace hausbench {

// A cell of the full octree.
struct Cursor {
    std::int32_t node = 0;
    std::int32_t depth = 0;
    Box cell;
};

inline Cursor root_of(const PointOctree& tree) { return {0, 0, tree.root_cell()}; }

// Calls f(Cursor) for the occupied parts of a cell, by ascending octant. Parts of a leaf never end: the caller
// decides when to stop halving.
template <class F> void for_each_part(const PointOctree& tree, const Cursor& at, F&& f) {
    const PointOctree::Node& node = tree.nodes()[static_cast<std::size_t>(at.node)];
    const auto below = [&](std::int32_t child, const PointOctree::Node& of) {
        const int octant = octant_of(at.cell, tree.points().row(of.first));
        f(Cursor{child, at.depth + 1, part_of(at.cell, octant)});
    };
    if (at.depth < node.depth || node.child_count == 0) return below(at.node, node);
    for (std::int32_t k = 0; k < node.child_count; ++k) {
        below(node.first_child + k, tree.nodes()[static_cast<std::size_t>(node.first_child + k)]);
    }
}

}  // namespace hausbench
