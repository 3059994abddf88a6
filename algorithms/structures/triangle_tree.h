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

// A tree of triangles. Each triangle is in exactly one leaf, a leaf has at most eight, and the triangles of a leaf
// share their vertices. A vector kernel measures the triangles whose boxes are near enough (Google Highway chooses the
// instruction set at run time; results have the same bits for all of them). Answers have the same bits as a plain scan
// (closest.h) and do not depend on the shape of the tree, because closest_point() returns a point inside the
// triangle's box, and a box is skipped only if no computed distance to a point inside could win. Coordinates may be up
// to 2^400.
class TriangleTree {
public:
    // Returns the same bits as closest_by_scan (closest.h). O(log n) on well-behaved meshes, O(n) at worst (from
    // the centre of a sphere).
    ClosestPoint closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const;

    // The same query, but every triangle is measured by textbook_closest_point (textbook.h): the answer of a program
    // that takes no care of rounding. Skips distances that are NaN; `triangle` is -1 if all of them are.
    ClosestPoint textbook_closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const;

    // Returns the same bits as certified_distance_by_scan (closest.h). O(log n) plus the number of triangles that are
    // about as near as the closest one.
    double certified_distance(const Vec3& point, Counters& counters) const;

    // Computes the squared distance from each of three points to each triangle of a leaf, with the same bits as
    // closest_point(): squared[k][i] is the one from points[k] to triangle i. Leaves out triangles whose boxes are
    // farther from `centre` than the radius, whose square is `squared_radius`. Returns a mask: if bit i is not set,
    // triangle i was left out, and squared[k][i] is undefined.
    unsigned leaf_distances(std::size_t leaf, const std::array<Vec3, 3>& points, const Vec3& centre,
                            double squared_radius, double (&squared)[3][leaf_capacity]) const;

    const WideTree& tree() const { return tree_; }
    const TriangleMesh& mesh() const { return *mesh_; }
    std::size_t bytes() const;

    // Updates the tree after vertices have moved: `mesh` must have the same triangles as the mesh before, in the same
    // order, and must outlive the tree. O(n). The shape of the tree stays, so queries become slower if triangles that
    // were neighbours move apart.
    void refit(const TriangleMesh& mesh);

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
