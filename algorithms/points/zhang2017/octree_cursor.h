// A cursor that walks an octree level by level. PointOctree stores no node for a level at which all points of a cell
// are in one octant; the cursor visits such levels, too. So a solver can stop at any depth or cell size.
#pragma once

#include "algorithms/points/zhang2017/point_octree.h"

namespace hausbench::zhang2017 {

// An octree cell that contains points. PointOctree may have no node for it.
struct Cursor {
    std::int32_t node = 0;   // the node of PointOctree with exactly the points of this cell
    std::int32_t depth = 0;  // depth of the cell; at most the depth of the node, unless the node is a leaf
    Box cell;
};

inline Cursor root_of(const PointOctree& tree) { return {0, 0, tree.root_cell()}; }

// Calls f(Cursor) for each octant of a cell that contains points, in ascending order. A leaf, too, has such an octant,
// with the same points, and so on without end; the caller must decide when to stop.
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

}  // namespace hausbench::zhang2017
