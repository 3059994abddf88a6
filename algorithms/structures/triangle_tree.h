// Closest point queries over the triangles of a mesh: what bvh.h and octree.h have in common.
#pragma once

#include "algorithms/kernel/closest.h"
#include "algorithms/structures/triangle_leaf.h"
#include "algorithms/structures/wide_tree.h"

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace hausbench {

// Each triangle is kept once, eight at most in a leaf; triangles of a leaf share their vertices. Those whose box is near
// enough are measured by one vector kernel (run-time dispatch by Google Highway; the same bits on every target). As closest_point clamps its answer to the triangle's box, a box is left
// out only where no computed distance inside could win: answers have the bits of a plain scan (closest.h) and do not
// depend on the shape of the tree. Coordinates up to 2^400.
class TriangleTree {
public:
    // O(log n) on well-behaved meshes, O(n) at worst (the centre of a sphere).
    ClosestPoint closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const;

    // The same with textbook_closest_point (textbook.h), triangle by triangle: the answer of a careless program.
    // Distances that are NaN are skipped; `triangle` is -1 if all are.
    ClosestPoint textbook_closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const;

    // Equals certified_distance_by_scan, to the bit. O(log n + the number of equally near triangles).
    double certified_distance(const Vec3& point, Counters& counters) const;

    // Returns squared distances of three points to the triangles of a leaf, as closest_point computes them:
    // squared[k][i] is the distance of points[k] to triangle i if bit i of the answer is set, and undefined
    // otherwise. It is set unless the triangle's box is farther from `centre` than `squared_radius`, squared.
    unsigned leaf_distances(std::size_t leaf, const std::array<Vec3, 3>& points, const Vec3& centre,
                            double squared_radius, double (&squared)[3][leaf_capacity]) const;

    const WideTree& tree() const { return tree_; }
    const TriangleMesh& mesh() const { return *mesh_; }
    std::size_t bytes() const;

    // Makes the tree fit `mesh`, which has the same triangles as before and vertices that moved; it must outlive this. O(n),
    // but queries get slower the more the neighbourhoods change.
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
    std::vector<std::int32_t> leaf_of_;  // of each triangle
};

}  // namespace hausbench
