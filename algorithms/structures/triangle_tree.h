// Closest point queries over the triangles of a mesh: the common part of bvh.h and octree.h.
#pragma once

#include "algorithms/kernel/closest.h"
#include "algorithms/structures/triangle_leaf.h"
#include "algorithms/structures/wide_tree.h"

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace hausbench {

// A tree of triangles. Each triangle is kept once, at most eight per leaf, and the triangles of a leaf share their
// vertices. Triangles whose box is near enough are measured by one vector kernel (run-time dispatch by Google
// Highway; the same bits on every target). closest_point clamps its answer to the triangle's box, so a box is left
// out only if no computed distance inside could win. Answers therefore have the same bits as a plain scan
// (closest.h) and do not depend on the shape of the tree. Coordinates up to 2^400.
class TriangleTree {
public:
    // Returns the same bits as closest_by_scan (closest.h). O(log n) on well-behaved meshes, O(n) at worst (from
    // the centre of a sphere).
    ClosestPoint closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const;

    // The same with textbook_closest_point (textbook.h), triangle by triangle: the answer of a careless program.
    // Distances that are NaN are skipped; `triangle` is -1 if all of them are.
    ClosestPoint textbook_closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const;

    // Returns the same bits as certified_distance_by_scan. O(log n) plus the number of triangles that are equally
    // near.
    double certified_distance(const Vec3& point, Counters& counters) const;

    // Computes squared distances from three points to the triangles of a leaf, as closest_point does: squared[k][i]
    // from points[k] to triangle i. Returns a mask: bit i is set unless the box of triangle i is farther than
    // `squared_radius` (squared) from `centre`. If bit i is not set, squared[k][i] is undefined.
    unsigned leaf_distances(std::size_t leaf, const std::array<Vec3, 3>& points, const Vec3& centre,
                            double squared_radius, double (&squared)[3][leaf_capacity]) const;

    const WideTree& tree() const { return tree_; }
    const TriangleMesh& mesh() const { return *mesh_; }
    std::size_t bytes() const;

    // Makes the tree fit `mesh`, which must have the same triangles as before, with vertices that moved; it must
    // outlive this. O(n), but queries become slower the more the neighbourhoods change.
    void refit(const TriangleMesh& mesh);

protected:
    TriangleTree(const TriangleMesh& mesh, WideTree&& tree);

private:
    void fill_leaves();

    const TriangleMesh* mesh_;
    WideTree tree_;
    std::unique_ptr<TriangleLeaf[]> leaves_;
    std::unique_ptr<double[]> vertices_;  // of the leaves
    std::size_t vertex_room_ = 0;
    std::vector<std::int32_t> leaf_of_;  // by triangle
};

}  // namespace hausbench
