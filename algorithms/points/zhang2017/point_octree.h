// Octree over a point set: the cells that Zhang et al. 2017 use for bounding and culling.
#pragma once

#include "algorithms/kernel/box.h"

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace hausbench {

// Returns an octant of `cell`; bit k of `octant` is set for the upper half on axis k. Points are sorted into octants
// by comparing them with the same middle, so an octant contains its points exactly, in spite of rounding.
Box part_of(const Box& cell, int octant);
int octant_of(const Box& cell, const Vec3& point);

// Cells are cubes; the root is a cube around the points, and cells are split down to single points. A cell whose
// points all lie in one octant would have a single child, so it is skipped; `depth` still counts its level. So a tree
// of n points has fewer than 2n nodes, and any coarser octree is a cut through it (octree_cursor.h).
class PointOctree {
public:
    static constexpr std::string_view structure_name = "point octree";
    static constexpr int structure_layout = 1;

    struct Node {
        Box cell;
        std::int32_t depth;  // halvings of the root's cube
        // No children: a leaf, with one point or several that coincide.
        std::int32_t first_child, child_count;
        std::int32_t first, count;  // range of its points in order()
    };

    // Copies the points. O(n depth) time, O(n) memory; coincident points share a leaf.
    explicit PointOctree(const Points& points);
    // The same with a given root, a cube that contains the points. Cells at depth `deepest` are not split, so these
    // leaves may have many points.
    PointOctree(const Points& points, const Box& root_cell, int deepest = max_depth);
    static Box root_around(const Points& points);

    const std::vector<Node>& nodes() const { return nodes_; }  // the root comes first
    const std::vector<Index>& order() const { return order_; }
    const Points& points() const { return points_; }     // sorted by order()
    const Box& root_cell() const { return root_cell_; }  // cube before any level is skipped

    std::size_t bytes() const;

    static constexpr int max_depth = 60;

private:
    void build(std::int32_t at, std::int32_t first, std::int32_t count, Box cell, int depth);

    int deepest_;
    Box root_cell_;
    std::vector<Node> nodes_;
    std::vector<Index> order_, scratch_;
    Points points_;
};

}  // namespace hausbench
