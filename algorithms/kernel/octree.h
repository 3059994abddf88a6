// Octree over the triangles of a mesh, for closest point queries.
#pragma once

#include "../scene.h"
#include "box.h"
#include "counters.h"
#include "point_triangle.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace hausbench {

struct ClosestPoint {
    double squared_distance = std::numeric_limits<double>::infinity();
    Vec3 point = Vec3::Zero();  // on the triangle
    Index triangle = -1;        // of several at the same squared distance, the one of lowest index
};

// What a query may be told beforehand. Neither hint changes an answer but as said.
struct ClosestHints {
    // Only triangles with squared distance <= this are looked for; `triangle` stays -1 if there is none.
    double squared_radius = std::numeric_limits<double>::infinity();
    // Early-out: stop as soon as some triangle is at most this far (squared); the answer is then that triangle, not the
    // closest one. Negative: never.
    double squared_enough = -1;
    // Looked at first, to start with a small radius; -1 for none. Without early-out the answer is the same bits.
    Index warm_triangle = -1;
};

// The answer of closest_point(point, triangle) (point_triangle.h) that is smallest over all triangles of `mesh`, by
// testing each. O(n). The octree returns the same bits.
ClosestPoint closest_by_scan(const TriangleMesh& mesh, const Vec3& point, const ClosestHints& hints, Counters& counters);

// A lower bound of the distance from `point` to the exact mesh, that holds under rounding: the least of the
// distance_certainly_at_least (point_triangle.h) of the triangles whose box is no farther than the closest one's computed
// distance, and that distance (rounded down) for the others. O(n). The octree returns the same bits.
double certified_distance_by_scan(const TriangleMesh& mesh, const Vec3& point, Counters& counters);

// Each triangle is kept once, in the leaf cell that the centre of its box falls into, and each cell knows the tight box
// of the triangles below it. As closest_point clamps its answer to the triangle's box, and the box
// distance is computed by the same operations, a cell is left out only where no computed distance inside could win: no
// slack is needed, and answers do not depend on the shape of the tree. Any coordinates with |c| <= 2^400.
class TriangleOctree {
public:
    // `mesh` must outlive this. O(n log n) time, O(n) memory; at most `max_depth` levels however the triangles lie.
    explicit TriangleOctree(const TriangleMesh& mesh);

    // O(log n) on well-behaved meshes, O(n) at worst (the centre of a sphere).
    ClosestPoint closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const;

    // As certified_distance_by_scan. O(log n) and what is equally near.
    double certified_distance(const Vec3& point, Counters& counters) const;

    std::size_t bytes() const;

    static constexpr int max_depth = 48;
    static constexpr int leaf_size = 8;

private:
    struct Node {
        Box box;
        std::int32_t first_child, child_count;  // 0 children: a leaf
        std::int32_t first, count;              // of the triangles, in the order of order_
    };

    struct Builder;
    template <class Leaf> void traverse(const Vec3& point, const double& bound, Counters& counters, Leaf&& leaf) const;

    const TriangleMesh* mesh_;
    std::vector<Node> nodes_;
    std::vector<Index> order_;         // triangle numbers, leaf by leaf, ascending in each
    std::vector<Triangle> triangles_;  // the corners, in the same order
};

}  // namespace hausbench
