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

// A tree over the triangles of a mesh, with up to eight in each leaf. Answers have the same bits as a plain scan
// (closest.h), for any shape of the tree and any instruction set. The reason: closest_point() returns a point inside
// the box of a triangle, and a box is skipped only if no computed distance to a point inside could win. Coordinates may
// be up to 2^400.
class TriangleTree {
public:
    // Returns the same closest point, bit for bit, as closest_by_scan (closest.h). O(log n) on well-behaved meshes,
    // O(n) at worst (from the centre of a sphere).
    ClosestPoint closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const;

    // Like closest(), but computes distances with textbook_closest_point (textbook.h), to show the answer of a program
    // that ignores rounding. Skips distances that are NaN; `triangle` is -1 if all of them are.
    ClosestPoint textbook_closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const;

    // Returns a proven lower bound on the exact distance, with the same bits as certified_distance_by_scan (closest.h).
    // O(log n) plus the number of triangles about as near as the closest one.
    double certified_distance(const Vec3& point, Counters& counters) const;

    // Computes squared[k][i], the squared distance from points[k] to triangle i of a leaf, with the same bits as
    // closest_point(). Skips triangles whose boxes are farther from `centre` than the root of `squared_radius`. Returns
    // a mask with a bit for each triangle that was not skipped; the distances to the others are undefined.
    unsigned leaf_distances(std::size_t leaf, const std::array<Vec3, 3>& points, const Vec3& centre,
                            double squared_radius, double (&squared)[3][leaf_capacity]) const;

    const WideTree& tree() const { return tree_; }
    const TriangleMesh& mesh() const { return *mesh_; }
    std::size_t bytes() const;

protected:
    TriangleTree(const TriangleMesh& mesh, WideTree&& tree);

private:
    void fill_leaves();

    const TriangleMesh* mesh_;
    WideTree tree_;
    std::unique_ptr<TriangleLeaf[]> leaves_;
    std::unique_ptr<double[]> vertices_;  // of all leaves, three numbers each
    std::size_t vertex_room_ = 0;         // number of vertices for which vertices_ has room
    std::vector<std::int32_t> leaf_of_;   // for each triangle, the number of its leaf
};

}  // namespace hausbench
