// Bounding volume hierarchies over triangles (triangle_tree.h) and points, for closest point queries.
//
// Eight children a node, eight elements a leaf, built by the surface area heuristic (build_bvh in wide_tree.h).
#pragma once

#include "algorithms/kernel/triangle_block.h"
#include "algorithms/structures/triangle_tree.h"

#include <string_view>

namespace hausbench {

class TriangleBvh : public TriangleTree {
public:
    static constexpr std::string_view structure_name = "BVH";
    static constexpr int structure_layout = 1;

    // `mesh` must outlive this. O(n log n) time, O(n) memory.
    explicit TriangleBvh(const TriangleMesh& mesh) : TriangleTree(mesh, build_bvh({mesh.vertices, &mesh.triangles})) {}
};

struct NearestPoint {
    double squared_distance = std::numeric_limits<double>::infinity();
    Index point = -1;  // of several at the same squared distance, the one of lowest index
};

class PointBvh {
public:
    static constexpr std::string_view structure_name = "point BVH";
    static constexpr int structure_layout = 1;

    // O(n log n) time, O(n) memory. At least one point; they are copied.
    explicit PointBvh(const Points& points);

    // The point of smallest squared_length(point - p), as rounded, among those at squared distance <= squared_radius; the
    // search ends early at one at squared distance <= early_out_squared (negative: never). O(log n) on well-behaved points.
    NearestPoint nearest(const Vec3& p, double squared_radius, double early_out_squared, Counters& counters) const;

    const WideTree& tree() const { return tree_; }
    std::size_t bytes() const;

    // Makes the tree fit points that have moved. O(n).
    void refit(const Points& points);

private:
    WideTree tree_;
    std::unique_ptr<PointBlock[]> blocks_;  // of each leaf
};

}  // namespace hausbench
